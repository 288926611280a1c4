#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <string_view>
#include <utility>

#include "io/mesh/checks/diagnose.h"
#include "io/mesh/checks/intrinsic.h"
#include "io/mesh/formats/coincident.h"
#include "io/mesh/formats/element_defects.h"
#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/text_lines.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/repair/face_soup.h"
#include "io/mesh/repair/repair_triangles.h"
#include "io/mesh/split_components.h"

namespace ricci {
namespace {

std::string lower(std::string text) {
    for (char& c : text) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c + ('a' - 'A')) : c;
    return text;
}

struct FileName {
    std::string stem, suffix;  // without folder and .gz; suffix in lower case, with its dot
    bool packed = false;
};

FileName split_name(const std::string& path) {
    std::filesystem::path name = std::filesystem::path(path).filename();
    FileName parts;
    parts.packed = lower(name.extension().string()) == ".gz";
    if (parts.packed) name = name.stem();
    parts.suffix = lower(name.extension().string());
    parts.stem = name.stem().string();
    return parts;
}

[[noreturn]] void throw_unsupported(const std::string& suffix) {
    std::string advice = "; supported are OBJ, OFF, PLY, STL (each also .gz) and .len";
    if (suffix == ".vtk" || suffix == ".vtp" || suffix == ".vtu") {
        advice = " (VTK); write it as PLY first, for instance with ParaView (File, Save Data)" + advice;
    } else if (suffix == ".mesh" || suffix == ".msh" || suffix == ".tet") {
        advice = " (a volume mesh); extract its boundary surface and write that as OFF or OBJ first" + advice;
    } else if (suffix == ".gltf" || suffix == ".glb" || suffix == ".fbx" || suffix == ".dae" ||
               suffix == ".3mf") {
        advice = " (a scene); export the mesh as OBJ or PLY first, for instance with Blender" + advice;
    }
    throw ContentError("unsupported_format", 0,
                       (suffix.empty() ? "the file name has no suffix that tells the format"
                                       : "the format " + shown(suffix) + " is not supported") +
                           advice);
}

ParsedFile parse(std::string_view bytes, const std::string& suffix) {
    using Parser = ParsedFile (*)(std::string_view);
    constexpr std::pair<std::string_view, Parser> kParsers[] = {{".obj", parse_obj},
                                                                {".off", parse_off},
                                                                {".ply", parse_ply},
                                                                {".stl", parse_stl},
                                                                {".len", parse_len}};
    for (const auto& [name, parser] : kParsers) {
        if (name != suffix) continue;
        if (bytes.empty()) throw ContentError("truncated", 0, "the file is empty");
        if (bytes.substr(0, 2) == "\x1f\x8b") {
            throw ContentError("unsupported_format", 0,
                               "the file is packed with gzip but not named .gz; rename it");
        }
        return parser(bytes);
    }
    throw_unsupported(suffix);
}

void note_unused(const PolygonSoup& soup, DefectList& notes) {
    std::vector<std::uint8_t> used(soup.points.size(), 0);
    for (const std::int64_t v : soup.corners) used[static_cast<std::size_t>(v)] = 1;
    std::vector<Index> unused;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] == 0) unused.push_back(static_cast<Index>(v));
    }
    if (unused.empty()) return;
    notes.add("unused_vertices", "vertex", unused.front(),
              std::to_string(unused.size()) + " vertices are used by no face: " + listed(unused));
}

/// Helps with surprising boundaries and components; not a defect, as surfaces may be cut open on purpose.
void note_coincident(const TriangleSoup& soup, std::span<const Point> points, DefectList& notes) {
    std::vector<std::uint8_t> used(points.size(), 0);
    for (const Triangle& t : soup.triangles) {
        for (const Index v : t) used[to_size(v)] = 1;
    }
    const std::vector<Index> first = first_at_position(points, used);
    std::vector<Index> repeated;
    for (std::size_t v = 0; v < first.size(); ++v) {
        if (to_size(first[v]) != v) repeated.push_back(static_cast<Index>(v));
    }
    if (repeated.empty()) return;
    notes.add(
        "coincident_vertices", "vertex", repeated.front(),
        std::to_string(repeated.size()) +
            " vertices lie at the position of a lower one and are kept apart (--repair weld merges them): " +
            listed(repeated));
}

/// Faces of positive area whose lengths, rounded, no longer make a triangle: they load, but flows may refuse
/// them.
void note_slivers(const TriangleSoup& soup, const SurfaceMesh& mesh, DefectList& notes) {
    std::vector<Index> slivers;
    for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
        std::array<double, 3> side = {mesh.edge_length[3 * f], mesh.edge_length[3 * f + 1],
                                      mesh.edge_length[3 * f + 2]};
        std::sort(side.begin(), side.end());
        if (!(side[2] - side[1] < side[0])) slivers.push_back(soup.source_face[f]);
    }
    if (slivers.empty()) return;
    notes.add(
        "sliver_face", "face", slivers.front(),
        std::to_string(slivers.size()) +
            " faces are so thin that their edge lengths, rounded to double, violate the strict triangle "
            "inequality: " +
            listed(slivers));
}

void note_components(const MeshReport& report, DefectList& notes) {
    if (report.components.value_or(1) <= 1) return;
    notes.add("components", "file", -1,
              std::to_string(*report.components) + " connected components, ordered by lowest vertex");
}

void finish_intrinsic(ParsedFile& file, const RepairOptions& repair, LoadedMesh& mesh) {
    IntrinsicSoup& soup = *file.intrinsic;
    if (repair.orient || repair.weld || repair.drop_degenerate) {
        file.notes.add("repair_not_applicable", "file", -1, "--repair has no effect on an intrinsic surface");
    }
    if (soup.tail.empty()) throw ContentError("no_faces", 0, "the file has no face");
    if (!file.errors.empty()) return;
    check_intrinsic(soup, file.errors);
    if (!file.errors.empty()) return;
    SurfaceMesh surface;
    surface.connectivity =
        connectivity_from_gluing(std::move(soup.tail), std::move(soup.twin), soup.vertex_count);
    surface.edge_length = std::move(soup.length);
    describe(surface, mesh.report);
    if (*mesh.report.vertices < soup.vertex_count) {
        file.notes.add(
            "unused_vertices", "file", -1,
            std::to_string(soup.vertex_count - *mesh.report.vertices) + " vertices are used by no face");
    }
    note_components(mesh.report, file.notes);
    mesh.components = split_components(std::move(surface));
}

void finish_embedded(ParsedFile& file, const RepairOptions& repair, LoadedMesh& mesh) {
    PolygonSoup& polygons = file.soup;
    check_corners(file);
    const auto faces_in_file = static_cast<std::int64_t>(polygons.face_count());
    if (file.errors.count("too_few_corners") == faces_in_file) {
        throw ContentError("no_faces", 0, "the file has no face with three corners");
    }
    if (!file.errors.empty()) return;
    check_limits(polygons);
    note_unused(polygons, file.notes);
    if (repair.weld) weld_vertices(polygons, file.notes);
    const FaceSoup faces = distinct_corners(polygons, repair.drop_degenerate, file.errors, file.notes);
    TriangleSoup soup = triangulate(faces, polygons.points, file.errors, file.notes);
    if (repair.orient) orient_faces(soup, static_cast<Index>(polygons.points.size()), file.notes);
    if (repair.drop_degenerate) remove_flat_faces(soup, polygons.points, file.notes);
    if (soup.triangles.empty()) {
        if (file.errors.empty())
            throw ContentError("no_faces", 0, "no face is left after --repair drop-degenerate");
        return;
    }
    diagnose(soup, polygons.points, repair, mesh.report, file.errors);
    note_components(mesh.report, file.notes);
    note_coincident(soup, polygons.points, file.notes);
    if (!file.errors.empty()) return;
    SurfaceMesh surface = make_surface_mesh(std::move(polygons.points), soup.triangles);
    note_slivers(soup, surface, file.notes);
    mesh.components = split_components(std::move(surface));
}

void add_content_error(const ContentError& error, DefectList& errors) {
    const bool has_line = error.line() > 0;
    errors.add(error.code(), has_line ? "line" : "file", has_line ? error.line() : -1,
               std::string(error.what()));
}

}  // namespace

RepairOptions parse_repair(const std::string& text) {
    RepairOptions options;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::size_t comma = rest.find(',');
        const std::string_view word = rest.substr(0, comma);
        if (word == "orient") {
            options.orient = true;
        } else if (word == "weld") {
            options.weld = true;
        } else if (word == "drop-degenerate") {
            options.drop_degenerate = true;
        } else {
            throw std::invalid_argument("--repair: unknown word " + shown(word) +
                                        "; known are orient, weld, drop-degenerate");
        }
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
        if (rest.empty()) throw std::invalid_argument("--repair: a word is missing after the last comma");
    }
    return options;
}

std::uint64_t mesh_hash(std::span<const Point> points, std::span<const Triangle> triangles) {
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
    if (!state) throw std::bad_alloc();
    XXH3_64bits_reset(state.get());
    XXH3_64bits_update(state.get(), points.data(), points.size_bytes());
    XXH3_64bits_update(state.get(), triangles.data(), triangles.size_bytes());
    return XXH3_64bits_digest(state.get());
}

LoadedMesh check_mesh(const std::string& name, std::span<const Point> points,
                      std::span<const Triangle> triangles, const RepairOptions& repair) {
    LoadedMesh mesh;
    mesh.report.file = mesh.stem = name;
    mesh.content_hash = mesh_hash(points, triangles);
    ParsedFile file;
    try {
        file.soup.points.reserve(points.size());
        for (const Point& point : points) add_point(file, point, 0);
        file.soup.corners.reserve(3 * triangles.size());
        file.soup.face_first.reserve(triangles.size() + 1);
        for (const Triangle& t : triangles) {
            file.soup.corners.insert(file.soup.corners.end(), t.begin(), t.end());
            file.soup.end_face();
        }
        if (triangles.empty()) throw ContentError("no_faces", 0, "there is no triangle");
        finish_embedded(file, repair, mesh);
    } catch (const ContentError& error) {
        add_content_error(error, file.errors);
    }
    mesh.report.notes = file.notes.defects();
    mesh.report.errors = file.errors.defects();
    return mesh;
}

LoadedMesh load_mesh(const std::string& path, const RepairOptions& repair) {
    return load_mesh_bytes(path, read_file_bytes(path), repair);
}

LoadedMesh load_mesh_bytes(const std::string& path, std::string bytes, const RepairOptions& repair) {
    LoadedMesh mesh;
    mesh.report.file = path;
    const FileName name = split_name(path);
    mesh.stem = name.stem;
    mesh.content_hash = XXH3_64bits(bytes.data(), bytes.size());
    ParsedFile file;
    try {
        if (name.packed) bytes = unpack_gzip(bytes, path);
        file = parse(bytes, name.suffix);
        std::string().swap(bytes);
        file.intrinsic ? finish_intrinsic(file, repair, mesh) : finish_embedded(file, repair, mesh);
    } catch (const ContentError& error) {
        add_content_error(error, file.errors);
    }
    mesh.report.notes = file.notes.defects();
    mesh.report.errors = file.errors.defects();
    return mesh;
}

}  // namespace ricci
