// HDF5 files that nobody vouches for: only the forms that this program writes are let in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/store/hdf5_file.h"

namespace ricci::hdf5 {

/// What the contents of a file of so many bytes may unpack to: 256 MiB, or 64 times its size if that is more.
std::uint64_t contents_limit(std::uint64_t file_bytes);

/// Complaints about the form of an open file; empty when it is one that this program writes:
/// * groups and datasets joined by hard links alone, each object met once (no soft or external links, no
///   loops, no named types), at most 64 deep, names without '/';
/// * types: integers, floats, enumerations of u1, variable-length texts and tables of them;
/// * values that lie in the file itself (no external storage, no virtual datasets), complete, in compact,
///   contiguous or chunked layout with no filters but shuffle, gzip and fletcher32;
/// * storage within the file's size, and contents_limit() for all that it unpacks to, texts included.
/// Texts and attributes are read and chunks unpacked, numbers are not looked at. Stops at the first
/// complaint.
std::vector<std::string> form_complaints(hid_t file, std::uint64_t file_bytes);

/// Walks over a file by form_complaints() in a child process under limits of time and memory: what makes HDF5
/// crash, loop or devour memory does so there. Throws FileError, naming the file and what is wrong with it.
/// The caller holds a Session.
void require_known_form(const std::string& path);

/// open_input() behind require_known_form(), which compares values with their checksums too. The caller holds
/// a Session.
Handle open_foreign(const std::string& path);

}  // namespace ricci::hdf5
