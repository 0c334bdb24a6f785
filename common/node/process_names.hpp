// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::node {

/// Names of programs that others ask or recognise: by them a process names itself in STATUS, and
/// the base driver in STOP.
inline constexpr const char* kBaseDriver = "nodmap-kurt";
inline constexpr const char* kNavigator = "nodmap-navigator";
inline constexpr const char* kExplorer = "nodmap-explorer";
inline constexpr const char* kSlam2d = "nodmap-slam2d";
inline constexpr const char* kSlam6d = "nodmap-slam6d";
inline constexpr const char* kLogger = "nodmap-logger";

}  // namespace nodmap::node
