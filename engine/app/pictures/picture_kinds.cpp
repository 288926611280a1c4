#include "engine/app/pictures/picture_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "engine/app/console.h"
#include "engine/app/pictures/layout_pictures.h"
#include "engine/app/result_values.h"
#include "io/picture/histogram.h"
#include "kernels/face_kernels.h"
#include "kernels/intrinsic_triangulation.h"

namespace ricci::app {
namespace {

constexpr std::array<std::pair<std::string_view, PictureKind>, 10> kKinds = {
    {{"domain", PictureKind::domain},
     {"tessellation", PictureKind::tessellation},
     {"checkerboard", PictureKind::checkerboard},
     {"texture", PictureKind::texture},
     {"surface", PictureKind::surface},
     {"curvature", PictureKind::curvature},
     {"distortion", PictureKind::distortion},
     {"surface-curvature", PictureKind::surface_curvature},
     {"surface-distortion", PictureKind::surface_distortion},
     {"angles", PictureKind::angles}}};

FaceColours colours_of(PictureKind kind, const PictureSource& source) {
    if (kind == PictureKind::curvature || kind == PictureKind::surface_curvature)
        return diverging_colours(face_curvature(*source.mesh), 0.0, "K");
    if (source.log_area_ratio.empty())
        throw UsageError("no area distortion to show: make the layout with --quality");
    return diverging_colours(source.log_area_ratio, 0.0, "log area");
}

SvgPicture draw_angles(const PictureSource& source) {
    if (source.angle_ratio.empty())
        throw UsageError("no angle ratios to show: make the layout with --quality");
    const Axis axis(0.5, 1.5, ScaleKind::linear);
    const Histogram regular = count_values(source.angle_ratio, axis, 100);
    std::optional<Histogram> curved;
    if (!source.curved_angle_ratio.empty()) curved = count_values(source.curved_angle_ratio, axis, 100);
    return draw_histogram(
        regular, curved,
        {"Angle in the layout / angle on the surface", "ratio", "corners", "where |K| > 5 % of 2 pi"},
        ScaleKind::linear, 1.0);
}

}  // namespace

double checker_cell(const StoredLayout& stored) {
    if (stored.layout.kappa != 0) return 2.0 / 24.0;
    double low = 0, high = 0;
    for (const auto& p : stored.layout.position) {
        low = std::min({low, p[0], p[1]});
        high = std::max({high, p[0], p[1]});
    }
    return std::max(high - low, 1e-12) / 24.0;
}

PictureKind parse_picture_kind(const std::string& text) {
    std::string known;
    for (const auto& [name, kind] : kKinds) {
        if (text == name) return kind;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    }
    throw UsageError(fmt::format("unknown picture '{}' (known: {})", text, known));
}

bool needs_quality(PictureKind kind) {
    return kind == PictureKind::distortion || kind == PictureKind::surface_distortion ||
           kind == PictureKind::angles;
}

void take_quality(const ConformalityReport& report, PictureSource& source) {
    source.log_area_ratio = report.log_area_ratio;
    for (std::size_t c = 0; c < report.pieces.ratio.size(); ++c) {
        if (report.pieces.kind[c] == CornerKind::regular)
            source.angle_ratio.push_back(report.pieces.ratio[c]);
        if (report.pieces.kind[c] == CornerKind::curved)
            source.curved_angle_ratio.push_back(report.pieces.ratio[c]);
    }
}

void take_stored_angles(const ResultGroup& quality, PictureSource& source) {
    const auto ratio = values_of<double>(quality, "angles/ratio");
    const auto kind = values_of<std::uint8_t>(quality, "angles/kind");
    for (std::size_t c = 0; c < std::min(ratio.size(), kind.size()); ++c) {
        if (kind[c] == static_cast<std::uint8_t>(CornerKind::regular)) source.angle_ratio.push_back(ratio[c]);
        if (kind[c] == static_cast<std::uint8_t>(CornerKind::curved))
            source.curved_angle_ratio.push_back(ratio[c]);
    }
}

std::vector<double> face_curvature(const SurfaceMesh& mesh) {
    const IntrinsicTriangulation<double> t = intrinsic_triangulation<double>(mesh);
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
    const std::vector<double> u(boundary.size(), 0.0);
    std::vector<double> angle(t.log_chord.size()), total(u.size());
    evaluate_faces<double>(Geometry::euclidean, ScaledChords<double>{t.connectivity.tail, t.log_chord, u},
                           {angle, {}, {}, {}}, false);
    sum_corners<double>(t.connectivity.tail, angle, total);
    std::vector<double> result;
    for (std::size_t h = 0; h < angle.size(); h += 3) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(t.connectivity.tail[h + k]);
            sum += (boundary[v] ? 1.0 : 2.0) * std::numbers::pi - total[v];
        }
        result.push_back(sum / 3);
    }
    return result;
}

SvgPicture draw_picture(PictureKind kind, LayoutModel model, const PictureSource& source) {
    const StoredLayout& stored = *source.layout;
    DomainPicture domain;
    domain.model = model;
    SurfacePicture surface;
    switch (kind) {
        case PictureKind::domain:
            return draw_domain(stored, domain);
        case PictureKind::tessellation:
            return draw_tessellation(stored, model);
        case PictureKind::checkerboard:
            domain.checker = checker_cell(stored);
            domain.labels = false;
            return draw_domain(stored, domain);
        case PictureKind::texture:
            surface.checker = checker_cell(stored);
            return draw_surface(stored, surface);
        case PictureKind::surface:
            surface.loops = source.generators;
            return draw_surface(stored, surface);
        case PictureKind::curvature:
        case PictureKind::distortion:
            domain.colours = colours_of(kind, source);
            return draw_domain(stored, domain);
        case PictureKind::surface_curvature:
        case PictureKind::surface_distortion:
            surface.colours = colours_of(kind, source);
            surface.loops = source.generators;
            return draw_surface(stored, surface);
        case PictureKind::angles:
            break;
    }
    return draw_angles(source);
}

}  // namespace ricci::app
