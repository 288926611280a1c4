#include "engine/surfaces/generate.h"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "engine/remesh/resample.h"
#include "engine/surfaces/grid.h"
#include "engine/surfaces/jitter.h"
#include "engine/surfaces/pattern_size.h"
#include "engine/surfaces/regular_map.h"
#include "engine/surfaces/ring_row.h"
#include "engine/surfaces/sphere.h"

namespace ricci {
namespace {

struct Generator {
    GeneratorInfo info;
    std::function<SurfaceMesh(const GenerateOptions&)> make;
};

/// The surface cut into four again and again, as often as comes nearest to the wanted number of faces in
/// ratio.
SurfaceMesh subdivided(SurfaceMesh mesh, Index faces) {
    check_face_count(faces);
    while (faces > 2.0 * mesh.connectivity.face_count()) {
        check_face_count(4.0 * mesh.connectivity.face_count());
        mesh = subdivide_midpoint(mesh);
    }
    return mesh;
}

SurfaceMesh handles(const GenerateOptions& options) {
    if (options.genus < 0) throw std::invalid_argument("generate: the genus must not be negative");
    if (options.genus == 0) return make_ellipsoid(options.faces, {1.0, 1.0, 1.0});
    return make_ring_row(options.faces, options.genus, RowPart::whole);
}

SurfaceMesh handles_with_boundary(const GenerateOptions& options) {
    if (options.genus < 1 || options.genus > std::numeric_limits<Index>::max() / 2) {
        throw std::invalid_argument("generate: genus-g-one-boundary needs a genus of at least 1 (0: disk)");
    }
    return make_ring_row(options.faces, 2 * options.genus, RowPart::right);
}

const std::vector<Generator>& table() {
    using Options = const GenerateOptions&;
    static const std::vector<Generator> generators = {
        {{"sphere", "unit sphere, from an icosahedron"},
         [](Options o) {
             return make_ellipsoid(o.faces, {1.0, 1.0, 1.0});
         }},
        {{"ellipsoid", "ellipsoid with semi-axes 1.5, 1, 0.75"},
         [](Options o) { return make_ellipsoid(o.faces, o.semi_axes); }},
        {{"torus", "torus of revolution (--major R --minor r), modulus i sqrt((R/r)^2 - 1)"},
         [](Options o) { return make_torus(o.faces, o.major_radius, o.minor_radius); }},
        {{"eight", "genus 2: two rings in a row"},
         [](Options o) { return make_ring_row(o.faces, 2, RowPart::whole); }},
        {{"genus-g", "closed surface of any genus (--genus g): a row of rings"}, handles},
        {{"pants", "sphere with three boundaries: the upper half of eight, which is its double"},
         [](Options o) { return make_ring_row(o.faces, 2, RowPart::upper); }},
        {{"annulus", "cylinder of circumference 2 pi (--height h), modulus h / (2 pi) at every resolution"},
         [](Options o) { return make_cylinder(o.faces, o.height); }},
        {{"annulus-planar", "plane annulus (--major R --minor r), modulus log(R/r) / (2 pi)"},
         [](Options o) { return make_plane_annulus(o.faces, o.major_radius, o.minor_radius); }},
        {{"disk", "flat unit disk"}, [](Options o) { return make_disk(o.faces); }},
        {{"punctured-torus", "genus 1 with one boundary: the right half of eight, which is its double"},
         [](Options o) { return make_ring_row(o.faces, 2, RowPart::right); }},
        {{"genus-g-one-boundary", "any genus (--genus g >= 1) with one boundary: half a row of 2g rings"},
         handles_with_boundary},
        {{"klein-quartic",
          "intrinsic {3,7}: genus 3, 24 vertices, 56 equilateral triangles, cut finer by fours"},
         [](Options o) { return subdivided(make_klein_quartic(), o.faces); }},
        {{"bolza", "intrinsic {3,8}: genus 2, 6 vertices, 16 equilateral triangles, cut finer by fours"},
         [](Options o) { return subdivided(make_bolza(), o.faces); }},
    };
    return generators;
}

}  // namespace

std::vector<GeneratorInfo> generators() {
    std::vector<GeneratorInfo> infos;
    for (const Generator& generator : table()) infos.push_back(generator.info);
    return infos;
}

SurfaceMesh generate(const std::string& name, const GenerateOptions& options) {
    std::string known;
    for (const Generator& generator : table()) {
        if (generator.info.name == name) {
            SurfaceMesh mesh = generator.make(options);
            return options.jitter == 0.0 ? mesh : jitter_surface(mesh, options.jitter, options.seed);
        }
        known += (known.empty() ? "" : ", ") + generator.info.name;
    }
    throw std::invalid_argument("generate: unknown surface '" + name + "'; known: " + known);
}

}  // namespace ricci
