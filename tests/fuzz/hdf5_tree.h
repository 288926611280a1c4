// A result file in memory: everything in it by name, so that it can be changed and written again with
// checksums that are right.
#pragma once

#include <string>
#include <vector>

#include "io/store/hdf5_file.h"
#include "tests/fuzz/fuzz_targets.h"

namespace ricci::fuzz {

/// Values of one type: numbers as bytes in row order, or texts.
struct TreeValues {
    hdf5::Handle type;
    hdf5::Shape shape;
    std::vector<std::byte> bytes;
    std::vector<std::string> texts;  // of variable-length types, `members` per value
    std::size_t members = 0;         // 0: numbers
};

struct TreeAttribute {
    std::string name;
    TreeValues values;
};

struct TreeObject {
    std::string path;  // "/items/a/mesh"; "" is the root
    bool group = false;
    TreeValues values;  // of a dataset
    std::vector<TreeAttribute> attributes;
};

/// In an order in which every group comes before what it holds.
using Tree = std::vector<TreeObject>;

Tree read_tree(const std::string& path);

/// Writes what can be written: objects whose group is missing, or that stand twice, are left out. Checksums
/// of groups that had one, and of all datasets, fit what is written.
void write_tree(const std::string& path, const Tree& tree);

/// Changes the tree as the bytes say, four by four: which object, what to do with it, where, with what.
void change_tree(Tree& tree, Bytes edits);

/// A copy, types included.
Tree copy_of(const Tree& tree);

}  // namespace ricci::fuzz
