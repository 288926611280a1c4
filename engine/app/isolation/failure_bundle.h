// A folder per failed item with all it takes to see the failure again: OUT.h5.failures/<item>/.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/app/isolation/child_process.h"
#include "io/store/run_store.h"

namespace ricci::app {

struct FailureBundle {
    FailureRecord failure;
    std::string mesh_file;                     // as given; its copy has the same name, without folders
    std::vector<std::string> arguments;        // of the program, run within the folder
    std::map<std::string, std::string> files;  // further ones that these name, with their text
    ChildEnd end;
};

/// Folder of an item's bundle.
std::string bundle_folder(const std::string& output, const std::string& item);
/// Name of the mesh in the bundle.
std::string bundled_mesh(const std::string& mesh_file);

/// Writes (or replaces) the bundle: the mesh file byte for byte, the further files, reproduce.sh,
/// failure.json (what happened, versions, the command of the whole run), stderr.txt. Trouble is returned as a
/// message, never thrown: a bundle must not hurt the run.
std::string write_bundle(const std::string& output, const FailureBundle& bundle);

/// Removes all bundles but those of these items, and their folder when it is empty.
void remove_other_bundles(const std::string& output, const std::vector<std::string>& items);

}  // namespace ricci::app
