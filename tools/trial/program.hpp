// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::trial {

/// nodmap-trial. Returns the exit code: 0 the trial was run, whatever came of it; 1 failed; 2 wrong
/// command line.
int run_trial(int argc, char** argv);

}  // namespace nodmap::trial
