#include "engine/app/sweep_items.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace ricci::app {

std::string stem_of(const std::string& file) {
    std::filesystem::path name = std::filesystem::path(file).filename();
    const std::string extension = name.extension().string();
    if (extension == ".gz" || extension == ".GZ") name = name.stem();
    return name.stem().string();
}

std::string SweepSource::stem() const {
    return loaded ? loaded->stem : stem_of(file);
}

std::string SweepSource::suffix() const {
    return name.substr(stem().size());
}

std::vector<SweepSource> sweep_sources(const std::vector<std::string>& files) {
    std::vector<SweepSource> sources;
    for (const std::string& file : files) sources.push_back({file, ""});
    name_sources(sources);
    return sources;
}

void name_sources(std::vector<SweepSource>& sources) {
    std::map<std::string, int> uses;
    for (SweepSource& source : sources) {
        const std::string stem = source.stem();
        const int use = ++uses[stem];
        source.name = use == 1 ? stem : fmt::format("{}~{}", stem, use);
    }
}

std::vector<ItemSummary> summaries_of(const std::vector<SweepItem>& items, const RunStore* store) {
    std::vector<ItemSummary> result;
    for (const SweepItem& item : items) {
        ItemSummary summary{item.name, item.status, item.message, item.vertices, 0, 0, {}, {}, item.seconds};
        if (item.stored && store != nullptr) {
            for (const SweepRow& row : store->finished_rows(item.name)) {
                if (row.status != static_cast<std::uint8_t>(Status::converged)) {
                    ++summary.failed;
                    continue;
                }
                ++summary.solved;
                if (!summary.best || row.area_distortion < summary.best->area_distortion) summary.best = row;
                if (!summary.worst || row.area_distortion > summary.worst->area_distortion)
                    summary.worst = row;
            }
        }
        result.push_back(std::move(summary));
    }
    return result;
}

std::vector<std::string> stored_names(const std::vector<SweepItem>& items,
                                      const std::vector<std::string>& files, const RunStore& store) {
    std::vector<std::string> names = stored_names(items);
    std::map<std::string, std::size_t> places;  // of files in the input, the first of equal ones
    for (const std::string& file : files) places.emplace(stored_form(file), places.size());
    const auto place = [&](const std::string& name) {
        const auto source = store.source_of(name);
        const auto found = source ? places.find(source->source) : places.end();
        return found == places.end() ? places.size() : found->second;
    };
    const std::set<std::string> met(names.begin(), names.end());
    for (const std::string& name : store.items()) {
        if (met.contains(name)) continue;
        const std::size_t own = place(name);
        names.insert(std::find_if(names.begin(), names.end(),
                                  [&](const std::string& other) { return place(other) > own; }),
                     name);
    }
    return names;
}

std::vector<std::string> stored_names(const std::vector<SweepItem>& items) {
    std::vector<std::string> names;
    for (const SweepItem& item : items)
        if (item.stored) names.push_back(item.name);
    return names;
}

}  // namespace ricci::app
