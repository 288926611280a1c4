#include "engine/app/path_record.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "engine/app/console.h"
#include "engine/app/pictures/distance_pictures.h"
#include "io/store/shape_index.h"

namespace ricci::app {
namespace {

/// The first frame that converged, or null.
const PathFrame* first_good(const std::vector<FollowedSequence>& sequences) {
    for (const FollowedSequence& s : sequences)
        for (const PathFrame& f : s.frames)
            if (f.status == Status::converged) return &f;
    return nullptr;
}

void append(std::vector<double>& rows, const std::vector<double>& row, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k)
        rows.push_back(k < row.size() ? row[k] : std::numeric_limits<double>::quiet_NaN());
}

PathRecord make_record(const FollowedSequence& s, const PathFrame* pattern) {
    PathRecord r;
    if (pattern) {
        r.type = type_name(pattern->genus, pattern->boundaries);
        r.names = pattern->names;
    }
    r.files = s.files;
    r.files.resize(s.frames.size());
    for (const PathFrame& f : s.frames) {
        r.marking.emplace_back(name_of(f.marking));
        r.message.push_back(f.message);
        r.status.push_back(static_cast<std::uint8_t>(f.status));
        append(r.coordinates, f.coordinates, r.names.size());
        append(r.fingerprint, f.fingerprint, pattern ? pattern->fingerprint.size() : 0);
        r.step.push_back(f.step);
        r.free_step.push_back(f.free_step);
        r.length.push_back(f.length);
        r.marking_number.push_back(f.marking_number);
        r.marking_gap.push_back(f.marking_gap);
        r.marking_spread.push_back(f.marking_spread);
    }
    return r;
}

}  // namespace

nlohmann::json frame_json(std::size_t sequence, std::size_t frame, const std::string& file,
                          const PathFrame& f) {
    return {{"file", file},
            {"sequence", sequence},
            {"frame", frame},
            {"status", name_of(f.status)},
            {"message", f.message},
            {"genus", f.genus},
            {"boundaries", f.boundaries},
            {"coordinates", f.coordinates},
            {"names", f.names},
            {"fingerprint", f.fingerprint},
            {"marking", name_of(f.marking)},
            {"marking_number", f.marking_number},
            {"gap", finite_or_null(f.marking_gap)},
            {"marking_spread", finite_or_null(f.marking_spread)},
            {"step", finite_or_null(f.step)},
            {"free_step", finite_or_null(f.free_step)},
            {"length", finite_or_null(f.length)}};
}

std::string frame_text(std::size_t frame, const std::string& file, const PathFrame& f) {
    if (f.status != Status::converged)
        return fmt::format("{:>4}  {}: {}: {}\n", frame, file, name_of(f.status), f.message);
    std::string line = fmt::format("{:>4}  {}  marking {}", frame, file, name_of(f.marking));
    if (f.marking != MarkingSource::none) line += fmt::format(" (gap {:.2g})", f.marking_gap);
    line += fmt::format(", step {:.6g}, without marking {:.6g}, length {:.6g}\n     ", f.step, f.free_step,
                        f.length);
    constexpr std::size_t kShown = 12;
    for (std::size_t k = 0; k < std::min(kShown, f.names.size()); ++k)
        line += fmt::format(" {} {:.6f}", f.names[k], f.coordinates[k]);
    if (f.names.size() > kShown) line += fmt::format(" ... ({} in all)", f.names.size());
    return line + "\n";
}

std::vector<PathRecord> make_path_records(const std::vector<FollowedSequence>& sequences) {
    const PathFrame* pattern = first_good(sequences);
    std::vector<PathRecord> records;
    records.reserve(sequences.size());
    for (const FollowedSequence& s : sequences) records.push_back(make_record(s, pattern));
    return records;
}

std::vector<DrawnSequence> drawn_sequences(const std::vector<FollowedSequence>& sequences) {
    std::vector<std::string> all;
    for (const FollowedSequence& s : sequences) all.insert(all.end(), s.files.begin(), s.files.end());
    const std::vector<std::string> names = short_names(all);
    std::vector<DrawnSequence> drawn;
    std::size_t next = 0;
    for (const FollowedSequence& s : sequences) {
        DrawnSequence d;
        Index marking = -1;
        for (std::size_t k = 0; k < s.files.size(); ++k, ++next) {
            if (k >= s.frames.size()) continue;
            const PathFrame& f = s.frames[k];
            const bool anew = marking >= 0 && f.marking_number >= 0 && f.marking_number != marking;
            d.frames.push_back({names[next], f.coordinates, anew});
            if (f.marking_number >= 0) marking = f.marking_number;
        }
        drawn.push_back(std::move(d));
    }
    return drawn;
}

}  // namespace ricci::app
