#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {

void add_generate(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand("generate", "Make a sample surface with known topology");
    struct Arguments {
        std::string name, output;
        GenerateOptions options;
    };
    auto arguments = std::make_shared<Arguments>();
    std::string names = "Surfaces:\n";
    for (const GeneratorInfo& info : generators())
        names += fmt::format("  {:<20} {}\n", info.name, info.description);
    command->add_option("NAME", arguments->name, "Which surface (list below)")->required();
    command->add_option("-o,--output", arguments->output, "File to write: .off, .obj, .ply, .len")
        ->required();
    command->add_option("--faces", arguments->options.faces, "About so many faces")->capture_default_str();
    command
        ->add_option("--major", arguments->options.major_radius,
                     "Torus: distance of the tube's centre from the axis")
        ->capture_default_str();
    command->add_option("--minor", arguments->options.minor_radius, "Torus: radius of the tube")
        ->capture_default_str();
    command->add_option("--genus", arguments->options.genus, "Genus of genus-g")->capture_default_str();
    command->add_option("--height", arguments->options.height, "Height of an annulus")->capture_default_str();
    command
        ->add_option("--jitter", arguments->options.jitter,
                     "Move vertices within the surface by up to this share of an edge")
        ->capture_default_str();
    command->add_option("--seed", arguments->options.seed, "Seed of the jitter")->capture_default_str();
    add_common(*command, common);
    command->footer(names + "Example: ricci generate torus --faces 20000 --major 2.5 --minor 1 -o torus.off");
    command->callback([&common, &action, arguments] {
        action = [&common, arguments] {
            const SurfaceMesh mesh = generate(arguments->name, arguments->options);
            const auto folder = std::filesystem::path(arguments->output).parent_path();
            if (!folder.empty()) std::filesystem::create_directories(folder);
            save_mesh(arguments->output, mesh);
            const Topology t = topology_of(mesh.connectivity);
            spdlog::info("{}: {} vertices, {} faces, genus {}, {} boundaries", arguments->output, t.vertices,
                         t.faces, t.genus, t.boundaries);
            if (common.json)
                print_json({{"file", arguments->output},
                            {"name", arguments->name},
                            {"vertices", t.vertices},
                            {"faces", t.faces},
                            {"genus", t.genus},
                            {"boundaries", t.boundaries}});
            return static_cast<int>(kDone);
        };
    });
}

}  // namespace ricci::app
