// What a page says about the geometric structure of a surface: the fundamental domain and its copies (thesis
// Figures 17 and 33), the cut and the generators on the surface, the group, charts.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "engine/app/pictures/layout_pictures.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/pictures/side_style.h"
#include "engine/app/report/item_report.h"
#include "engine/app/result_values.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMostCopies = 1200, kMostCurves = 120;
constexpr double kFarthestCopy = 8.0;  // hyperbolic distance; beyond, copies are below a pixel
constexpr double kPixels = 600.0;

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// "a1" of "a1^-1": what both sides of a pair are called.
std::string pair_name(const std::string& side) {
    const std::size_t inverse = side.find("^-1");
    return inverse == std::string::npos ? side : side.substr(0, inverse);
}

/// The sides' paths on the surface, each pair once, in the colours that they have in the domain.
void add_cut(const StoredLayout& stored, const SurfaceMesh& mesh, const std::string& link, ItemReport& out) {
    const std::vector<int> pair = pair_numbers(stored.cut);
    std::set<int> drawn;
    for (std::size_t s = 0; s < stored.cut.sides.size() && out.scene.curves.size() < kMostCurves; ++s) {
        const CutSide& side = stored.cut.sides[s];
        if (side.halfedges.empty() || (pair[s] >= 0 && !drawn.insert(pair[s]).second)) continue;
        const Paint paint = side_paint(pair[s], 2.5);
        SceneCurve curve{
            pair_name(side.name), link, paint.stroke.value_or(kBlack), !paint.dashes.empty(), {}};
        for (const Index h : side.halfedges)
            curve.points.push_back(mesh.points[at(mesh.connectivity.tail[at(h)])]);
        curve.points.push_back(mesh.points[at(mesh.connectivity.head(side.halfedges.back()))]);
        out.scene.curves.push_back(std::move(curve));
    }
}

/// The generators' loops, hidden until they are asked for: they run along the cut and across it.
void add_generators(const StoredLayout& stored, const ResultGroup& layout, const SurfaceMesh& mesh,
                    ItemReport& out) {
    const auto names = values_of<std::string>(layout, "generators/name");
    for (std::size_t g = 0; g < std::min(names.size(), stored.generators.size()) && g < kMostCurves; ++g) {
        const Paint paint = pair_paint(g, 2.5);
        SceneCurve curve{"generator " + names[g], "", paint.stroke.value_or(kBlack), true, {}, true};
        for (const Index v : stored.generators[g])
            if (at(v) < mesh.points.size()) curve.points.push_back(mesh.points[at(v)]);
        out.scene.curves.push_back(std::move(curve));
    }
}

/// Vertices of the layout that are vertices of the view.
void add_layout_points(const StoredLayout& stored, const std::string& link, ItemReport& out) {
    const std::set<Index> seen(out.scene.mesh.vertex.begin(), out.scene.mesh.vertex.end());
    out.scene.layout_link = link;
    for (std::size_t l = 0; l < stored.layout.position.size(); ++l) {
        const Index v = stored.layout.refinement_vertex[l];
        if (!seen.contains(v)) continue;
        out.scene.layout_points.push_back(conformal_point(stored.layout.kappa, stored.layout.position[l]));
        out.scene.layout_vertex.push_back(v);
    }
}

struct NamedModel {
    LayoutModel model;
    const char* name;
};
std::vector<NamedModel> models_of(int kappa) {
    if (kappa < 0) return {{LayoutModel::conformal, "Poincare disk"}, {LayoutModel::klein, "Klein disk"}};
    if (kappa > 0) return {{LayoutModel::conformal, "sphere, stereographic"}};
    return {{LayoutModel::conformal, "plane"}};
}

void add_domains(const StoredLayout& stored, const std::string& link, ReportContext& context,
                 ItemReport& out) {
    ReportPage& page = *context.page;
    std::vector<PageFigure> figures;
    for (const NamedModel& m : models_of(stored.layout.kappa)) {
        DomainPicture picture;
        picture.model = m.model;
        picture.pixels = kPixels;
        figures.push_back(page.make_figure(
            fmt::format("domain, {}", m.name), draw_domain(stored, picture),
            stored.cut.sides.empty()
                ? "Seen from a pole of the sphere, around which a small disk is left out."
                : "The surface cut along the coloured curves and laid out. Sides of one colour "
                  "are glued.",
            m.model == LayoutModel::klein ? link + " klein" : link));
    }
    DomainPicture checker;
    checker.checker = checker_cell(stored);
    checker.pixels = kPixels;
    figures.push_back(page.make_figure("checkerboard", draw_domain(stored, checker),
                                       "The checkerboard that the view shows on the surface.", link));
    out.figures.push_back(std::move(figures));
}

void add_tessellation(const StoredLayout& stored, const std::string& link, ReportContext& context,
                      ItemReport& out) {
    if (stored.layout.pairings.empty()) return;
    ReportPage& page = *context.page;
    StoredLayout tiled = stored;
    if (tiled.copies.empty())
        tiled.copies =
            tessellate(stored.layout, kMostCopies, stored.layout.kappa < 0 ? kFarthestCopy : INFINITY);
    std::vector<PageFigure> figures;
    for (const NamedModel& m : models_of(stored.layout.kappa))
        figures.push_back(page.make_figure(
            fmt::format("tessellation, {}", m.name), draw_tessellation(tiled, m.model, kPixels),
            "Copies of the domain under deck transformations, neighbours in different "
            "colours: a part of the universal cover.",
            m.model == LayoutModel::klein ? link + " klein" : link));
    out.figures.push_back(std::move(figures));
}

std::string entry(double x) {
    return fmt::format("{:.8g}", x == 0.0 ? 0.0 : x);
}

PageTable generator_table(const ResultGroup& layout, int kappa) {
    PageTable table{"Generators and their deck transformations", {"name", "word", "matrix"}, {}, {}};
    const auto names = values_of<std::string>(layout, "generators/name"),
               words = values_of<std::string>(layout, "generators/word");
    const auto half = values_of<double>(layout, "generators/half_plane"),
               matrix = values_of<double>(layout, "generators/matrix");
    const bool two = kappa < 0 && half.size() == 4 * names.size();
    const std::size_t n = two ? 2 : 3;
    const std::vector<double>& entries = two ? half : matrix;
    for (std::size_t g = 0; g < names.size() && entries.size() >= (g + 1) * n * n && g < words.size(); ++g) {
        std::string text = "<code>";
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j)
                text += (j > 0 ? " &ensp;" : "") + entry(entries[g * n * n + i * n + j]);
            text += i + 1 < n ? "<br>" : "</code>";
        }
        const Paint paint = pair_paint(g, 2.5);
        table.rows.push_back(
            {fmt::format("<i class=\"swatch\" style=\"background:{}\"></i> {}",
                         hexadecimal(paint.stroke.value_or(kBlack)), ReportPage::text(names[g])),
             ReportPage::text(words[g]), text});
    }
    if (two) table.caption += " in SL(2,R)";
    return table;
}

void check_layout(const std::string& item, const ResultGroup& layout, ReportContext& context) {
    ReportPage& page = *context.page;
    const auto number = [&](const char* name) { return attribute_of<double>(layout, name).value_or(NAN); };
    const auto count = [&](const char* name) { return attribute_of<std::int64_t>(layout, name); };
    const auto digits = [&](const char* name) {
        return fmt::format("in {} digits", attribute_of<std::int32_t>(layout, name).value_or(16));
    };
    Invariant relator = bounded(item, "layout", "relator error, max entry of |product - identity|",
                                number("relator_error"), 1e-10, 1e-6),
              closing = bounded(item, "layout", "closing error", number("closing_error"), 1e-10, 1e-6);
    relator.note = digits("group_digits");
    closing.note = digits("layout_digits");
    page.check(relator);
    page.check(closing);
    page.check(none_of(item, "layout", "flipped pieces", count("flipped_pieces"), Verdict::fails));
    page.check(none_of(item, "layout", "degenerate pieces", count("degenerate_pieces"), Verdict::look));
    Invariant unresolved = none_of(item, "layout", "pieces whose orientation doubles cannot show",
                                   count("unresolved_pieces"), Verdict::look);
    unresolved.note = "they turn the right way by their own frames";
    page.check(unresolved);
}

void add_atlas(const StoredItem& item, const ResultGroup& atlas, ReportContext& context, ItemReport& out) {
    ReportPage& page = *context.page;
    const std::string kind = attribute_of<std::string>(atlas, "kind").value_or("") + " atlas";
    const auto number = [&](const char* name) { return attribute_of<double>(atlas, name).value_or(NAN); };
    const std::string& name = item.item.name;
    page.check(
        bounded(name, kind, "disagreement of charts at vertices", number("vertex_disagreement"), 1e-9, 1e-5));
    page.check(bounded(name, kind, "cocycle error", number("cocycle_error"), 1e-9, 1e-5));
    std::optional<std::int64_t> uncovered;
    if (const auto stored = attribute_of<std::int32_t>(atlas, "uncovered_vertices")) uncovered = *stored;
    page.check(none_of(name, kind, "vertices outside all charts", uncovered, Verdict::look));
    if (!context.draw) return;
    const std::vector<std::vector<Index>> charts = lists_of<Index>(atlas, "charts/vertex");
    SceneField field{
        fmt::format("chart ({})", kind),
        "",
        std::vector<double>(static_cast<std::size_t>(std::max<std::size_t>(item.item.points.size(), 1)), NAN),
        std::nullopt,
        NumberKind::integers,
        {}};
    for (std::size_t k = charts.size(); k-- > 0;)
        for (const Index v : charts[k])
            if (v >= 0 && at(v) < field.values.size()) field.values[at(v)] = static_cast<double>(k);
    field.colours = ColourScale{Axis(0.0, std::max(1.0, static_cast<double>(charts.size()) - 1.0)),
                                ColourMap::sequential};
    if (item.item.points.size() == field.values.size()) out.scene.fields.push_back(std::move(field));
    out.notes.push_back(
        fmt::format("{}: {} charts, {} transition maps. A vertex of several charts has the colour of the "
                    "first of them.",
                    kind, charts.size(), values_of<Index>(atlas, "transitions/to").size()));
}

}  // namespace

void add_structure(const StoredItem& item, const SurfaceMesh& mesh, ReportContext& context, ItemReport& out) {
    const ResultGroup* layout = result_of(item, "layout");
    if (const ResultGroup* atlas = result_of(item, "atlas");
        atlas != nullptr && atlas->status == static_cast<std::uint8_t>(Status::converged))
        add_atlas(item, *atlas, context, out);
    if (layout == nullptr || layout->status != static_cast<std::uint8_t>(Status::converged)) return;
    check_layout(item.item.name, *layout, context);
    if (!context.draw) return;
    const StoredLayout stored = read_layout_group(*layout, item.item.triangles.size());
    const std::string link = context.page->new_link();
    if (!mesh.intrinsic()) {
        add_cut(stored, mesh, link, out);
        add_generators(stored, *layout, mesh, out);
        add_layout_points(stored, link, out);
        if (std::optional<SceneTexture> texture = layout_texture("checkerboard of the layout", stored);
            texture && context.has_room(26 * texture->triangles.size()))
            out.scene.textures.push_back(std::move(*texture));
    }
    add_domains(stored, link, context, out);
    add_tessellation(stored, link, context, out);
    PageTable table = generator_table(*layout, stored.layout.kappa);
    if (!table.rows.empty()) out.folded.push_back(std::move(table));
}

}  // namespace ricci::app
