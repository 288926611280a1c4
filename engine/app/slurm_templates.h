// The scripts in configs/slurm, as they stand there.
#pragma once

namespace ricci::app {

extern const char* const kArrayTemplate;
extern const char* const kMergeTemplate;
extern const char* const kSubmitTemplate;

}  // namespace ricci::app
