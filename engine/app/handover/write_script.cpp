#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "engine/app/console.h"
#include "engine/app/handover/handover.h"
#include "engine/app/handover/script_templates.h"
#include "io/store/durable.h"

namespace ricci::app {
namespace {

constexpr std::array<std::pair<std::string_view, ScriptKind>, 3> kKinds = {
    {{"blender", ScriptKind::blender},
     {"polyscope", ScriptKind::polyscope},
     {"paraview", ScriptKind::paraview}}};

/// A file name as a Python expression, whatever its bytes.
std::string python_name(const std::string& name) {
    std::string text;
    bool plain = true;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        plain = plain && byte < 0x80;
        if (byte < 0x20 || byte >= 0x7F || c == '"' || c == '\\')
            text += fmt::format("\\x{:02x}", byte);
        else
            text += c;
    }
    return plain ? "\"" + text + "\"" : "os.fsdecode(b\"" + text + "\")";
}

/// NAME of NAME.blender.py, or of NAME.py.
std::filesystem::path stem_of(const std::string& path) {
    std::filesystem::path stem = std::filesystem::path(path).replace_extension();
    const std::string inner = stem.extension().string();
    for (const auto& [name, kind] : kKinds)
        if (inner == "." + std::string(name)) return stem.replace_extension();
    return stem;
}

std::string with_data(std::string_view script, const std::string& data) {
    constexpr std::string_view kPlace = "\"DATA_FILE\"";
    const std::size_t place = script.find(kPlace);
    return std::string(script.substr(0, place)) + python_name(data) +
           std::string(script.substr(place + kPlace.size()));
}

const char* script_of(ScriptKind kind) {
    if (kind == ScriptKind::blender) return kBlenderScript;
    return kind == ScriptKind::polyscope ? kPolyscopeScript : kParaviewScript;
}

}  // namespace

ScriptKind script_kind(const std::string& path, const std::string& wanted) {
    // Python would take the script for the module that it imports.
    const std::string module = std::filesystem::path(path).stem().string();
    for (const char* taken : {"polyscope", "paraview", "bpy", "bmesh", "numpy", "json"})
        if (module == taken)
            throw UsageError(
                fmt::format("'{}' is the name of a module that the script needs: take another", path));
    const std::string inner = std::filesystem::path(path).replace_extension().extension().string();
    for (const auto& [name, kind] : kKinds) {
        const bool named = inner == "." + std::string(name);
        if (named && !wanted.empty() && wanted != name)
            throw UsageError(fmt::format("'{}' is named for {}, --for says {}", path, name, wanted));
        if (named || wanted == name) return kind;
    }
    throw UsageError(
        fmt::format("'{}': name the script .blender.py, .polyscope.py or .paraview.py, or say --for", path));
}

void write_script(const std::string& path, ScriptKind kind, const ItemSource& source,
                  const HandoverOptions& options) {
    std::filesystem::path data = stem_of(path);
    if (kind == ScriptKind::paraview) {
        data += ".vtm";
        write_multiblock(data.string(), {&source}, {""}, options, true);
    } else {
        data += ".npz";
        write_npz(data.string(), source, options);
    }
    write_text_durably(path, with_data(script_of(kind), data.filename().string()));
}

}  // namespace ricci::app
