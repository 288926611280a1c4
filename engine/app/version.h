// What was built: stored in every result file and printed by --version.
#pragma once

namespace ricci {

/// The project's version, "major.minor.patch".
const char* ricci_version();

/// The commit of the source tree at build time, 40 hex digits, followed by "-dirty" where tracked files had
/// changed; "unknown" when built outside git.
const char* ricci_git();

}  // namespace ricci
