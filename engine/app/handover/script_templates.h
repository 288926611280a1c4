// The scripts in engine/app/handover/scripts, as they stand there.
#pragma once

namespace ricci::app {

extern const char* const kBlenderScript;
extern const char* const kPolyscopeScript;
extern const char* const kParaviewScript;

}  // namespace ricci::app
