#include "engine/app/coordinates_record.h"

#include "engine/app/accuracy_record.h"
#include "engine/app/console.h"
#include "engine/app/result_arrays.h"

namespace ricci::app {
namespace {

void add_curves(ResultArrays& arrays, const std::string& path, const std::vector<CoordinateCurve>& curves) {
    std::vector<std::string> names, words;
    std::vector<double> lengths;
    std::vector<std::vector<Point>> points;
    for (const CoordinateCurve& c : curves) {
        names.push_back(c.name);
        words.push_back(c.word);
        lengths.push_back(c.length);
        points.push_back(c.curve.points);
    }
    arrays.list(path + "/name", std::move(names));
    arrays.list(path + "/length", std::move(lengths));
    arrays.list(path + "/word", std::move(words));
    arrays.polylines(path + "/points", points);
}

nlohmann::json curves_json(const std::vector<CoordinateCurve>& curves) {
    nlohmann::json list = nlohmann::json::array();
    for (const CoordinateCurve& c : curves)
        list.push_back({{"name", c.name}, {"length", finite_or_null(c.length)}, {"word", c.word}});
    return list;
}

}  // namespace

ResultGroup make_coordinates_group(const std::string& item, const SurfaceCoordinates& s) {
    ResultGroup group;
    group.item = item;
    group.kind = "teichmuller";
    group.status = static_cast<std::uint8_t>(s.status);
    group.attributes = {{"geometry", std::string(name_of(s.geometry))}};
    add_accuracy(s.accuracy, group);
    if (s.status != Status::converged) return group;
    group.attributes.push_back({"marking", s.marking});
    group.attributes.push_back({"smallest_gap", s.smallest_gap});
    ResultArrays arrays(group);
    arrays.list("coordinates", s.coordinates);
    arrays.list("names", s.names);
    if (s.geometry == Geometry::euclidean && s.genus == 1) {
        group.attributes.push_back({"length_ratio", s.length_ratio});
        group.attributes.push_back({"angle", s.angle});
    }
    if (!s.curves.empty()) add_curves(arrays, "curves", s.curves);
    if (!s.loops.empty()) add_curves(arrays, "loops", s.loops);
    if (s.seams) arrays.list("hexagon_seams", std::vector<double>(s.seams->begin(), s.seams->end()));
    std::vector<std::string> names;
    std::vector<double> lengths, twists, gaps;
    for (const FenchelNielsen& f : s.pants) {
        names.push_back(f.name);
        lengths.push_back(f.length);
        twists.push_back(f.twist);
    }
    if (!names.empty()) {
        arrays.list("fenchel_nielsen/name", names);
        arrays.list("fenchel_nielsen/length", lengths);
        arrays.list("fenchel_nielsen/twist", twists);
    }
    names.clear();
    for (const MarkingChoice& c : s.choices) {
        names.push_back(c.name);
        gaps.push_back(c.gap);
    }
    if (names.empty()) return group;
    arrays.list("choices/name", names);
    arrays.list("choices/gap", gaps);
    return group;
}

nlohmann::json coordinates_json(const SurfaceCoordinates& s) {
    nlohmann::json object = {{"genus", s.genus},
                             {"boundaries", s.boundaries},
                             {"geometry", name_of(s.geometry)},
                             {"status", name_of(s.status)},
                             {"message", s.message},
                             {"coordinates", s.coordinates},
                             {"names", s.names}};
    add_accuracy(s.accuracy, object);
    nlohmann::json choices = nlohmann::json::array();
    for (const MarkingChoice& c : s.choices) choices.push_back({{"name", c.name}, {"gap", c.gap}});
    object["marking"] = {{"kind", s.marking}, {"smallest_gap", s.smallest_gap}, {"choices", choices}};
    if (s.status != Status::converged) return object;
    if (s.geometry == Geometry::hyperbolic) {
        object["curves"] = curves_json(s.curves);
        object["fenchel_nielsen"] = nlohmann::json::array();
        for (const FenchelNielsen& f : s.pants)
            object["fenchel_nielsen"].push_back(
                {{"name", f.name}, {"length", f.length}, {"twist", finite_or_null(f.twist)}});
    }
    if (s.seams) object["hexagon_seams"] = *s.seams;
    if (s.geometry == Geometry::euclidean) {
        if (s.genus == 1) {
            object["modulus_re"] = s.modulus_re;
            object["modulus_im"] = s.modulus_im;
            object["length_ratio"] = s.length_ratio;
            object["angle"] = s.angle;
        } else {
            object["modulus"] = s.modulus;
        }
    }
    if (!s.loops.empty()) object["loops"] = curves_json(s.loops);
    return object;
}

std::vector<NamedCurve> named_curves(const SurfaceCoordinates& s) {
    std::vector<NamedCurve> curves;
    for (const CoordinateCurve& c : s.curves)
        if (!c.curve.points.empty()) curves.push_back({c.name, c.length, c.curve.points});
    return curves;
}

}  // namespace ricci::app
