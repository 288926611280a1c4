// Places where the tests make a process fail. Costs one look at the environment, so it belongs at places that
// wait for a disk, a solve or a whole stage anyway.
#pragma once

#include <string_view>

namespace ricci {

/// Acts out the faults that the environment asks for here: RICCI_FAULT=FAULT[;FAULT]..., each
/// NAME[@SUBJECT]:PASS[:ACTION], at the PASS-th time (from 1, in this process) that the point NAME is passed
/// with that subject, or with any where none is named. ACTION is
///   kill      SIGKILL (the default)
///   segv      SIGSEGV
///   abort     std::abort()
///   hang      never returns
///   allocate  fills memory, a MiB per millisecond, until there is no more (at most 4 GiB)
///   reserve   asks for memory and does not touch it, until there is no more (at most 64 GiB)
///   throw     std::runtime_error
/// A subject may hold anything but ';'.
void fault_point(const char* name, std::string_view subject = {});

}  // namespace ricci
