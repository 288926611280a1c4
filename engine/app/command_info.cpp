#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

template <class T>
nlohmann::json or_null(const std::optional<T>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json to_json(const std::vector<Defect>& defects) {
    nlohmann::json list = nlohmann::json::array();
    for (const Defect& d : defects)
        list.push_back(
            {{"code", d.code}, {"element", d.element}, {"index", d.index}, {"message", d.message}});
    return list;
}

nlohmann::json to_json(const MeshReport& r) {
    return {{"file", r.file},
            {"vertices", or_null(r.vertices)},
            {"edges", or_null(r.edges)},
            {"faces", or_null(r.faces)},
            {"components", or_null(r.components)},
            {"boundaries", or_null(r.boundaries)},
            {"genus", or_null(r.genus)},
            {"euler_characteristic", or_null(r.euler_characteristic)},
            {"manifold", or_null(r.manifold)},
            {"oriented", or_null(r.oriented)},
            {"min_angle_deg", or_null(r.min_angle_deg)},
            {"obtuse_fraction", or_null(r.obtuse_fraction)},
            {"notes", to_json(r.notes)},
            {"errors", to_json(r.errors)}};
}

template <class T>
std::string or_dash(const std::optional<T>& value) {
    return value ? fmt::format("{}", *value) : "-";
}

void print_text(const MeshReport& r) {
    std::string text = fmt::format("{}\n", r.file);
    text += fmt::format("  vertices {}  edges {}  faces {}\n", or_dash(r.vertices), or_dash(r.edges),
                        or_dash(r.faces));
    text += fmt::format("  components {}  boundaries {}  genus {}  Euler characteristic {}\n",
                        or_dash(r.components), or_dash(r.boundaries), or_dash(r.genus),
                        or_dash(r.euler_characteristic));
    text += fmt::format("  manifold {}  oriented {}  smallest angle {} deg  obtuse faces {}\n",
                        or_dash(r.manifold), or_dash(r.oriented), or_dash(r.min_angle_deg),
                        or_dash(r.obtuse_fraction));
    for (const Defect& d : r.notes) text += fmt::format("  note: {}\n", d.message);
    for (const Defect& d : r.errors) text += fmt::format("  error [{}]: {}\n", d.code, d.message);
    std::fputs(text.c_str(), stdout);
}

int info(const std::vector<std::string>& arguments, const RepairOptions& repair, bool json) {
    const std::vector<std::string> files = expand_inputs(arguments);
    int status = kDone;
    for (const std::string& file : files) {
        MeshReport report;
        try {
            report = load_mesh(file, repair).report;
        } catch (const FileError& e) {
            spdlog::error("{}", e.what());
            report.file = file;
            report.errors.push_back({"unreadable", "file", -1, e.what()});
            status = files.size() == 1 ? kEnvironment : kSomeFailed;
        }
        if (json) {
            print_json(to_json(report));
        } else {
            print_text(report);
        }
        if (!report.errors.empty() && status == kDone) status = kSomeFailed;
    }
    return status;
}

}  // namespace

void add_info(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("info", "Topology and quality of meshes, and every defect with element numbers");
    auto files = std::make_shared<std::vector<std::string>>();
    auto repair = std::make_shared<std::string>();
    command->add_option("MESH", *files, "Files, folders or globs")->required();
    command->add_option("--repair", *repair, "Changes to make: orient,weld,drop-degenerate");
    add_common(*command, common);
    command->footer("Example: ricci info bunny.obj --json");
    command->callback([&common, &action, files, repair] {
        action = [&common, files, repair] { return info(*files, parse_repair(*repair), common.json); };
    });
}

}  // namespace ricci::app
