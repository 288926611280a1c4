// ricci_make_variants: data sets for experiments with shape spaces, out of a few meshes.
//
// Variants of a mesh that are the same shape (bench/mesh_variants.h), or, with --deform, new shapes by smooth
// maps of space (bench/space_deformation.h). Same options, same bits. Every file is read back and checked:
// sound, of the same topological type. One JSON object per file on stdout.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/mesh_variants.h"
#include "bench/random_numbers.h"
#include "bench/space_deformation.h"
#include "bench/surfaces.h"
#include "engine/remesh/resample.h"
#include "io/mesh/mesh_file.h"

namespace {

using ricci::Index;
using ricci::SurfaceMesh;

struct Options {
    std::vector<std::string> meshes;
    std::filesystem::path folder;
    std::uint64_t seed = 1;
    Index deform = 0;  // so many new shapes instead of variants
    Index faces = 0;   // deformations: of about so many faces; variants: the mesh decimated to that first
    Index most_faces = 60000;  // of a variant
    double strength = 1.0;
};

std::uint64_t mixed(std::uint64_t seed, std::uint64_t number) {
    return seed * 0x9e3779b97f4a7c15U + number * 0xbf58476d1ce4e5b9U + 1;
}

/// Saves, reads back and compares; empty where all is well, else what is wrong.
std::string save_checked(const std::filesystem::path& path, const SurfaceMesh& mesh,
                         const SurfaceMesh& source) {
    ricci::save_mesh(path.string(), mesh);
    const ricci::LoadedMesh back = ricci::load_mesh(path.string());
    if (!back.report.errors.empty()) return back.report.errors.front().message;
    if (back.components.size() != 1) return "several components";
    const ricci::Topology now = topology_of(back.components.front().connectivity);
    const ricci::Topology before = topology_of(source.connectivity);
    if (now.genus != before.genus || now.boundaries != before.boundaries) return "another topological type";
    return "";
}

nlohmann::json record(const std::filesystem::path& path, const std::string& source, const SurfaceMesh& mesh) {
    const ricci::Topology type = topology_of(mesh.connectivity);
    return {{"file", path.string()},
            {"source", source},
            {"genus", type.genus},
            {"boundaries", type.boundaries},
            {"vertices", type.vertices},
            {"faces", type.faces},
            {"min_angle_deg", ricci::bench::smallest_angle(mesh)}};
}

/// One variant, if it can be made; else the reason on stderr.
bool write_variant(const Options& options, const std::string& source, const SurfaceMesh& mesh,
                   const ricci::bench::VariantMaker& maker, std::uint64_t number) {
    const std::filesystem::path path =
        options.folder / (std::filesystem::path(source).stem().string() + "." + maker.name + ".off");
    std::string problem;
    try {
        const SurfaceMesh made = maker.make(mesh, mixed(options.seed, number));
        problem = save_checked(path, made, mesh);
        if (problem.empty()) {
            nlohmann::json line = record(path, source, made);
            line["variant"] = maker.name;
            std::cout << line.dump() << "\n" << std::flush;
            return true;
        }
        std::filesystem::remove(path);
    } catch (const std::invalid_argument& error) {
        problem = error.what();
    } catch (const std::runtime_error& error) {
        problem = error.what();
    }
    std::cerr << source << ": no " << maker.name << ": " << problem << "\n";
    return false;
}

/// Returns how many of the ten could be made, stand-ins included.
std::size_t write_variants(const Options& options, const std::string& source) {
    SurfaceMesh mesh = ricci::bench::load_single(source);
    if (options.faces > 0 && mesh.connectivity.face_count() > options.faces)
        mesh = ricci::resample(mesh, options.faces).mesh;
    const auto makers = ricci::bench::variant_makers(options.most_faces);
    const auto substitutes = ricci::bench::substitute_makers();
    std::size_t made = 0, next_substitute = 0;
    std::uint64_t number = 0;
    for (const auto& maker : makers) {
        bool done = write_variant(options, source, mesh, maker, ++number);
        while (!done && next_substitute < substitutes.size()) {
            const std::size_t k = next_substitute++;
            done = write_variant(options, source, mesh, substitutes[k], makers.size() + k + 1);
        }
        made += done ? 1 : 0;
    }
    return made;
}

/// New shapes, the meshes taking turns; the seed of a shape is in its name.
bool write_deformations(const Options& options) {
    std::vector<SurfaceMesh> meshes;
    for (const std::string& source : options.meshes) {
        SurfaceMesh mesh = ricci::bench::load_single(source);
        if (options.faces > 0) mesh = ricci::resample(mesh, options.faces).mesh;
        meshes.push_back(std::move(mesh));
    }
    bool good = true;
    for (Index i = 0; i < options.deform; ++i) {
        const std::size_t k = static_cast<std::size_t>(i) % meshes.size();
        std::array<char, 32> suffix{};
        std::snprintf(suffix.data(), suffix.size(), ".deformed%05d.off", static_cast<int>(i));
        const std::string stem = std::filesystem::path(options.meshes[k]).stem().string();
        const std::filesystem::path path = options.folder / (stem + suffix.data());
        const auto made = ricci::bench::deform_space(meshes[k], options.strength,
                                                     mixed(options.seed, static_cast<std::uint64_t>(i)));
        const std::string problem = save_checked(path, made.mesh, meshes[k]);
        if (!problem.empty()) {
            std::cerr << path.string() << ": " << problem << "\n";
            good = false;
            continue;
        }
        nlohmann::json line = record(path, options.meshes[k], made.mesh);
        line["strength"] = made.strength;
        line["stretch"] = {made.smallest_stretch, made.largest_stretch};
        std::cout << line.dump() << "\n" << std::flush;
    }
    return good;
}

int run(const Options& options) {
    constexpr std::size_t kFewestVariants = 8;
    std::filesystem::create_directories(options.folder);
    if (options.deform > 0) return write_deformations(options) ? 0 : 1;
    bool good = true;
    for (const std::string& source : options.meshes) {
        const std::size_t made = write_variants(options, source);
        if (made < kFewestVariants) std::cerr << source << ": only " << made << " variants\n";
        good = good && made >= kFewestVariants;
    }
    return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Variants of meshes that are the same shape, or with --deform new shapes made of them");
    app.add_option("MESH", options.meshes, "Meshes, one sound component each")->required();
    app.add_option("-o,--output", options.folder, "Folder of the files")->required();
    app.add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
    app.add_option("--deform", options.deform,
                   "So many new shapes by smooth maps of space, the meshes taking turns");
    app.add_option("--faces", options.faces,
                   "Resample to about so many faces first (variants: only where there are more)");
    app.add_option("--most-faces", options.most_faces, "No variant has more")->capture_default_str();
    app.add_option("--strength", options.strength, "Of the deformations")->capture_default_str();
    CLI11_PARSE(app, argc, argv)
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::cerr << "ricci_make_variants: " << error.what() << "\n";
        return 3;
    }
}
