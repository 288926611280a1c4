#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/natural_order.h"
#include "engine/app/path_record.h"
#include "engine/app/records.h"
#include "engine/app/shape_arguments.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct PathArguments {
    SolveArguments solve;
    std::vector<std::string> files;
    std::vector<std::vector<std::string>> further;  // after each --and
    std::string output, svg;
};

/// Throws UsageError before anything is done.
std::vector<FollowedSequence> make_sequences(const PathArguments& a) {
    if (!a.output.empty() && !a.output.ends_with(".csv") && !a.output.ends_with(".h5"))
        throw UsageError(fmt::format("'{}' ends neither in .csv nor in .h5", a.output));
    flow_options(a.solve);
    std::vector<FollowedSequence> sequences{{expand_in_natural_order(a.files), {}}};
    for (const std::vector<std::string>& files : a.further)
        if (!files.empty()) sequences.push_back({expand_in_natural_order(files), {}});
    for (const FollowedSequence& s : sequences)
        if (std::is_sorted(s.files.begin(), s.files.end()) &&
            !std::is_sorted(s.files.begin(), s.files.end(), natural_less))
            spdlog::warn(
                "frames are taken in the order given, which is that of the alphabet and not of numbers: "
                "quote the "
                "glob, or name the folder, to have frame2 before frame10");
    return sequences;
}

/// Follows sequences frame by frame.
class PathRun {
  public:
    PathRun(const PathArguments& arguments, const CommonOptions& common)
        : a_(arguments),
          common_(common),
          quiet_input_(common),
          sequences_(make_sequences(arguments)),
          path_(options()) {
        quiet_input_.json = false;
    }

    int run() {
        catch_signals();
        std::size_t files = 0;
        for (const FollowedSequence& s : sequences_) files += s.files.size();
        alone_ = files == 1;
        for (std::size_t s = 0; s < sequences_.size(); ++s) follow(s);
        write();
        return caught_signal() != 0 ? 128 + caught_signal() : good_ ? kDone : kSomeFailed;
    }

  private:
    [[nodiscard]] ShapeOptions options() const {
        ShapeOptions o;
        o.flow = flow_options(a_.solve);
        o.flow.parallel = common_.resolved_threads() > 1;
        return o;
    }

    void follow(std::size_t number) {
        FollowedSequence& s = sequences_[number];
        path_.begin_sequence();
        if (!common_.json && sequences_.size() > 1) fmt::print("sequence {}\n", number + 1);
        for (std::size_t k = 0; k < s.files.size() && caught_signal() == 0; ++k) {
            const PathFrame frame = frame_of(s.files[k]);
            if (caught_signal() != 0) break;
            report(number, k, s.files[k], frame);
            s.frames.push_back(frame);
        }
    }

    PathFrame frame_of(const std::string& file) {
        std::optional<LoadedMesh> loaded;
        try {
            loaded = load_input(file, a_.solve.repair, quiet_input_);
        } catch (const FileError& e) {
            if (alone_) throw;
            return failed_frame(Status::invalid_input, e.what());
        }
        if (!loaded)
            return failed_frame(Status::invalid_input, "the mesh has defects; ricci info names them");
        if (loaded->components.size() != 1)
            return failed_frame(Status::invalid_input, fmt::format("{} components: a frame is one surface",
                                                                   loaded->components.size()));
        PathFrame frame;
        path_.set_interruption(interruption(a_.solve.timeout));
        with_thread_limit(common_.resolved_threads(), [&] { frame = path_.add(loaded->components.front()); });
        return frame;
    }

    void report(std::size_t number, std::size_t k, const std::string& file, const PathFrame& frame) {
        if (frame.status != Status::converged) {
            good_ = false;
            spdlog::error("{}: {}: {}", file, name_of(frame.status), frame.message);
        } else if (!frame.message.empty()) {
            spdlog::warn("{}: {}", file, frame.message);
        }
        if (common_.json)
            print_json(frame_json(number + 1, k, file, frame));
        else
            fmt::print("{}", frame_text(k, file, frame));
    }

    void write() const {
        if (!a_.output.empty()) {
            const RunInfo info = make_run_info(to_toml(a_.solve), command_line(), common_.resolved_threads());
            const std::vector<PathRecord> records = make_path_records(sequences_);
            if (a_.output.ends_with(".csv"))
                write_path_csv(a_.output, info.status, records);
            else
                write_path_file(a_.output, info, records);
        }
        if (a_.svg.empty()) return;
        for (const PathRecord& r : make_path_records(sequences_)) {
            if (r.names.empty()) continue;
            draw_path(drawn_sequences(sequences_), r.names, "Path in shape space, " + r.type).save(a_.svg);
            return;
        }
        spdlog::error("{}: no frame converged, nothing to draw", a_.svg);
    }

    const PathArguments& a_;
    const CommonOptions& common_;
    CommonOptions quiet_input_;  // failures of a file are reported with its frame
    std::vector<FollowedSequence> sequences_;
    ShapePath path_;
    bool alone_ = false, good_ = true;
};

}  // namespace

void add_path(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("path", "A sequence of meshes as a curve in shape space, followed and drawn");
    auto a = std::make_shared<PathArguments>();
    add_shape_arguments(*command, a->solve, a->files);
    command
        ->add_option("--and", a->further,
                     "MESH... of a further sequence, repeatable: drawn in the same picture")
        ->expected(-1);
    command->add_option("-o,--output", a->output, "Table of all frames, .csv or .h5");
    command->add_option("--svg", a->svg,
                        "Picture: the curve in its two principal components, and all coordinates");
    command->footer(
        "Frames are taken in the order given; folders and quoted globs in natural order (frame2 before "
        "frame10). Where "
        "frames have the same triangles the marking of the first is carried along, so that coordinates are "
        "continuous; "
        "others take their own (docs/shape_space.md), and jump where a near-tie is decided the other way "
        "(gap). A torus "
        "is followed in the upper half plane, across the boundaries of the fundamental domain. A frame that "
        "fails is "
        "recorded and skipped. All sequences are of the topological type of the first frame.\n"
        "Example: ricci path 'bend/*.off' --and 'twist/*.off' -o paths.csv --svg paths.svg");
    add_common(*command, common);
    command->callback([a, &common, &action] { action = [a, &common] { return PathRun(*a, common).run(); }; });
}

}  // namespace ricci::app
