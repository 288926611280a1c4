#include "engine/app/spectrum_record.h"

#include "engine/app/accuracy_record.h"
#include "engine/app/console.h"
#include "engine/app/result_arrays.h"

namespace ricci::app {

ResultGroup make_spectrum_group(const std::string& item, const SurfaceSpectrum& s) {
    ResultGroup group;
    group.item = item;
    group.kind = "spectrum";
    group.status = static_cast<std::uint8_t>(s.status);
    group.attributes = {{"geometry", std::string(name_of(s.geometry))}};
    add_accuracy(s.accuracy, group);
    if (s.status != Status::converged) return group;
    group.attributes.push_back({"complete_up_to", s.complete_up_to});
    group.attributes.push_back({"relator_error", s.relator_error});
    group.attributes.push_back({"word_error", s.word_error});
    group.attributes.push_back({"unit", s.unit});
    ResultArrays arrays(group);
    std::vector<Index> of, boundary;
    for (const std::size_t k : s.geodesic) of.push_back(static_cast<Index>(k));
    std::vector<double> lengths;
    std::vector<std::string> words;
    std::vector<std::vector<Point>> points;
    for (const SurfaceGeodesic& g : s.geodesics) {
        lengths.push_back(g.length);
        boundary.push_back(g.boundary);
        words.push_back(g.word);
        points.push_back(g.curve.points);
    }
    arrays.list("length", s.lengths);
    arrays.list("power", s.power);
    arrays.list("geodesic", std::move(of));
    arrays.list("geodesics/length", std::move(lengths));
    arrays.list("geodesics/boundary", std::move(boundary));
    arrays.list("geodesics/word", std::move(words));
    arrays.polylines("geodesics/points", points);
    return group;
}

nlohmann::json spectrum_json(const SurfaceSpectrum& s) {
    nlohmann::json object = {{"genus", s.genus},
                             {"boundaries", s.boundaries},
                             {"geometry", name_of(s.geometry)},
                             {"status", name_of(s.status)},
                             {"message", s.message},
                             {"lengths", s.lengths},
                             {"primitive", nlohmann::json::array()},
                             {"powers", s.power},
                             {"geodesics", nlohmann::json::array()},
                             {"words", nlohmann::json::array()},
                             {"boundary", nlohmann::json::array()},
                             {"complete_up_to", s.complete_up_to},
                             {"relator_error", finite_or_null(s.relator_error)},
                             {"word_error", finite_or_null(s.word_error)},
                             {"unit", s.unit}};
    add_accuracy(s.accuracy, object);
    for (std::size_t k = 0; k < s.lengths.size(); ++k) {
        const SurfaceGeodesic& g = s.geodesics[s.geodesic[k]];
        object["primitive"].push_back(s.power[k] == 1);
        object["geodesics"].push_back(s.geodesic[k]);
        object["words"].push_back(
            s.power[k] == 1 || g.word.empty() ? g.word : "(" + g.word + ")^" + std::to_string(s.power[k]));
        object["boundary"].push_back(g.boundary);
    }
    return object;
}

std::vector<NamedCurve> named_curves(const SurfaceSpectrum& s) {
    std::vector<NamedCurve> curves;
    for (std::size_t k = 0; k < s.geodesics.size(); ++k)
        if (!s.geodesics[k].curve.points.empty())
            curves.push_back({"g" + std::to_string(k), s.geodesics[k].length, s.geodesics[k].curve.points});
    return curves;
}

SvgPicture draw_spectrum(const SurfaceMesh& mesh, const SurfaceSpectrum& s) {
    std::vector<DrawnCurve> curves;
    for (const NamedCurve& c : named_curves(s)) curves.push_back({c.name, c.points, {}});
    return draw_curves(mesh, curves);
}

}  // namespace ricci::app
