#include <cstdio>

#include "engine/structure/surface_structure.h"
#include "io/mesh/mesh_file.h"

int main(int, char** argv) {
    const ricci::LoadedMesh loaded = ricci::load_mesh(argv[1]);
    for (const ricci::Defect& defect : loaded.report.errors)
        std::fprintf(stderr, "%s\n", defect.message.c_str());
    for (const ricci::SurfaceMesh& mesh : loaded.components) {
        const ricci::SurfaceStructure s = ricci::make_surface_structure(mesh, {});
        std::printf("residual %g, relator error %g\n", s.flow.outcome.residual_max, s.group.relator_error);
    }
}
