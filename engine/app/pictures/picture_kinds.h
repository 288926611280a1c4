// The pictures that `ricci layout` and `ricci export` offer by name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/app/stored_layout.h"
#include "engine/quality/conformality.h"
#include "io/picture/svg.h"
#include "io/store/result_group.h"
#include "kernels/surface_mesh.h"

namespace ricci::app {

/// domain, tessellation, checkerboard (of the domain), texture (the checkerboard on the surface in space),
/// surface (with the generators), curvature and distortion (colours of the domain), surface-curvature and
/// surface-distortion (in space), angles (histogram of the ratios, thesis Figure 54).
enum class PictureKind : std::uint8_t {
    domain,
    tessellation,
    checkerboard,
    texture,
    surface,
    curvature,
    distortion,
    surface_curvature,
    surface_distortion,
    angles
};

/// Throws UsageError naming those that exist.
PictureKind parse_picture_kind(const std::string& text);
/// Whether a picture needs angle ratios or area distortion.
bool needs_quality(PictureKind kind);

struct PictureSource {
    const StoredLayout* layout = nullptr;
    const SurfaceMesh* mesh = nullptr;
    std::vector<std::vector<Index>> generators;  // vertex paths on the mesh
    std::vector<double> log_area_ratio;          // F, or empty
    std::vector<double> angle_ratio;             // regular corners, or empty
    std::vector<double> curved_angle_ratio;      // at curved vertices
};

/// Takes what pictures need from a report.
void take_quality(const ConformalityReport& report, PictureSource& source);

/// Takes the ratios of angles of a stored quality group.
void take_stored_angles(const ResultGroup& quality, PictureSource& source);

/// Side of the squares of a checkerboard in the layout's own coordinates: about twenty-four across the
/// domain.
double checker_cell(const StoredLayout& stored);

/// Curvature of the mesh at a face: mean over its corners of 2 pi (boundary: pi) less the angle sum, radians.
/// // F
std::vector<double> face_curvature(const SurfaceMesh& mesh);

/// Throws UsageError where the source lacks what the picture shows.
SvgPicture draw_picture(PictureKind kind, LayoutModel model, const PictureSource& source);

}  // namespace ricci::app
