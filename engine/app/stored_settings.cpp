#include "engine/app/stored_settings.h"

#include <string>

#include "engine/app/console.h"
#include "engine/app/solve_options.h"
#include "engine/app/toml_text.h"

namespace ricci::app {

namespace {

StoredSettings parsed_settings(const StoredRun& run) {
    StoredSettings s;
    const toml::table root = parse_toml(run.info.config, "the stored configuration");
    const auto text = [&](const char* key, const std::string& fallback) {
        return root["solve"][key].value_or(fallback);
    };
    s.scheme = parse_scheme(text("scheme", "vertex-scaling"));
    const std::string boundary = text("boundary", "geodesic");
    s.boundary = parse_boundary(boundary.empty() ? "geodesic" : boundary);
    s.delaunay = parse_delaunay(text("delaunay", "isometric"));
    s.densify = root["solve"]["densify"].value_or(false);
    s.tolerance = root["solve"]["tolerance"].value_or(s.tolerance);
    const std::string cone = text("cone_curvature", "");
    if (!cone.empty()) s.cone_curvature = parse_curvature(cone);
    return s;
}

}  // namespace

StoredSettings settings_of(const StoredRun& run) {
    try {
        return parsed_settings(run);
    } catch (const UsageError& error) {  // nobody typed it: the file is at fault
        throw FileError(error.what());
    }
}

}  // namespace ricci::app
