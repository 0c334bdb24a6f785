// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::procman {

/// main() of nodmap-sheriff.
int run_sheriff_program(int argc, char** argv);

}  // namespace nodmap::procman
