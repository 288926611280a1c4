// The command line of `ricci`.
#pragma once

namespace ricci::app {

/// Exit status (docs: interface contract).
enum ExitStatus : int { kDone = 0, kSomeFailed = 1, kUsage = 2, kEnvironment = 3 };

/// Runs one command; never throws.
int run(int argc, char** argv);

}  // namespace ricci::app
