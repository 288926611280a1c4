#include "engine/app/isolation/isolated_index.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <utility>

#include "engine/app/isolation/child_main.h"
#include "engine/app/isolation/failure_bundle.h"
#include "engine/app/sweep_items.h"
#include "io/store/durable.h"

namespace ricci::app {
namespace {

constexpr double kBlockSeconds = 3.0;
constexpr std::size_t kBlockFiles = 64;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

IsolatedIndex::IsolatedIndex(IndexBuild& build, const std::vector<IndexBuild::Reading*>& order,
                             std::string output, ProgressLine& progress)
    : build_(&build), output_(std::move(output)), progress_(&progress) {
    for (IndexBuild::Reading* reading : order) {
        tasks_.emplace_back();
        tasks_.back().reading = reading;
    }
    progress_now_.sources = progress_now_.sources_opened = order.size();
    progress_now_.solves_known = static_cast<std::int64_t>(order.size());
}

std::string IsolatedIndex::bundle_name(const std::string& file, std::uint64_t hash, std::int32_t component) {
    return fmt::format("{}-{}.c{}", stem_of(file), hex16(hash), component);
}

const std::string& IsolatedIndex::file_of(const Work& work) const {
    return build_->inputs_[work.reading->input].file;
}

void IsolatedIndex::finish(Work& work) {
    finished_.push_back(work.reading);
    ++progress_now_.solves_done;
    progress_now_.seconds = seconds_since(start_);
    progress_->show(progress_now_);
}

/// The hash of its bytes, or why it has none.
void IsolatedIndex::look_at(Work& work) {
    IndexBuild::Reading& reading = *work.reading;
    std::error_code error;
    if (std::filesystem::exists(file_of(work), error) &&
        !std::filesystem::is_regular_file(file_of(work), error)) {
        reading.load_error = file_of(work) + ": no regular file: --isolate reads each twice";
        return;
    }
    try {
        reading.hash = checksum_of(std::string_view(read_text(file_of(work))));
    } catch (const FileError& e) {
        reading.load_error = e.what();
    } catch (const std::bad_alloc&) {
        reading.load_error = file_of(work) + ": memory ran out";
    }
}

std::optional<std::string> IsolatedIndex::job(std::size_t task, const ChildShare& share) {
    Work& work = tasks_[task];
    IndexBuild::Reading& reading = *work.reading;
    const IndexStore& store = *build_->store_;
    const bool first = !work.begun;
    work.begun = true;
    if (first) look_at(work);
    reading.reused = first && reading.load_error.empty() && store.known_components(reading.hash) > 0;
    if (reading.reused || !reading.load_error.empty()) {
        finish(work);
        return std::nullopt;
    }
    if (first && !claimed_.emplace(reading.hash, task).second) {
        twins_.push_back(task);
        return std::nullopt;
    }
    if (first)  // of a run that is resumed
        for (const std::int32_t c : store.components_known(reading.hash)) work.described.insert(c);
    work.component = 0;
    while (work.described.contains(work.component)) ++work.component;
    work.done = false;
    work.exception.clear();
    const std::vector<std::int32_t> skip(work.described.begin(), work.described.end());
    MessageWriter job;
    put_header(job, {"describe", share});
    return job.put(file_of(work)).put(to_toml(build_->config_)).put(skip).bytes();
}

void IsolatedIndex::message(std::size_t task, const Frame& frame,
                            const std::function<void(std::string_view)>& /*reply*/) {
    Work& work = tasks_[task];
    MessageReader reader(frame.bytes);
    if (frame.kind == kDoneMessage) {
        work.done = true;
        return;
    }
    if (frame.kind == kExceptionMessage) {
        reader.get_text();
        work.exception = reader.get_text();
        return;
    }
    switch (static_cast<DescribeMessage>(frame.kind)) {
        case DescribeMessage::component:
            work.component = reader.get<std::int32_t>();
            work.components = reader.get<std::int32_t>();
            return;
        case DescribeMessage::shape: {
            ShapeRecord shape = reader.get_shape();
            if (shape.hash != work.reading->hash)
                throw ProtocolError("it describes other bytes than those of its file: did it change?");
            if (shape.component != work.component || !work.described.insert(shape.component).second)
                throw ProtocolError("it describes a component that is not its turn");
            work.reading->shapes.push_back(std::move(shape));
            return;
        }
        case DescribeMessage::load_error:
            work.reading->load_error = reader.get_text();
            return;
    }
    throw ProtocolError(fmt::format("it sent a message of unknown kind {}", frame.kind));
}

IsolatedWork::Verdict IsolatedIndex::ended(std::size_t task, const ChildEnd& end, const ChildShare& share) {
    Work& work = tasks_[task];
    if (end.stopped) {
        // Whole components only: the others are described when the build is resumed.
        if (!work.reading->shapes.empty()) finish(work);
        return Verdict::finished;
    }
    if (work.done) {
        finish(work);
        return Verdict::finished;
    }
    if (deserves_all(end, share)) {
        spdlog::warn("{}: {}; to be tried again alone", file_of(work), end.fate());
        return Verdict::alone;
    }
    // Between two components nothing was under way. The next child begins with one that is to blame.
    if (!work.described.contains(work.component)) record_death(work, end);
    if (static_cast<std::int32_t>(work.described.size()) < work.components) return Verdict::again;
    finish(work);
    return Verdict::finished;
}

void IsolatedIndex::record_death(Work& work, const ChildEnd& end) {
    const std::string name = bundle_name(file_of(work), work.reading->hash, work.component);
    ShapeRecord shape;
    shape.hash = work.reading->hash;
    shape.component = work.component;
    shape.components = work.components;
    shape.status = static_cast<std::uint8_t>(work.exception.empty() ? end.status() : Status::internal_error);
    shape.message = fmt::format("{}; reproducer in {}", work.exception.empty() ? end.fate() : work.exception,
                                bundle_folder(output_, name));
    FailureBundle bundle;
    bundle.failure = {name, "describe", std::string(name_of(static_cast<Status>(shape.status))),
                      shape.message};
    bundle.mesh_file = file_of(work);
    bundle.end = end;
    bundle.arguments = {"index", "build", bundled_mesh(bundle.mesh_file), "-o", "reproduced.h5"};
    const std::vector<std::string> options = index_arguments(build_->config_);
    bundle.arguments.insert(bundle.arguments.end(), options.begin(), options.end());
    if (const std::string trouble = write_bundle(output_, bundle); !trouble.empty())
        spdlog::warn("{}", trouble);
    work.described.insert(shape.component);
    work.reading->shapes.push_back(std::move(shape));
}

void IsolatedIndex::settle() {
    for (const std::size_t task : std::exchange(twins_, {})) {
        Work& twin = tasks_[task];
        const Work& first = tasks_[claimed_.at(twin.reading->hash)];
        std::string error = first.reading->load_error;
        if (const std::string& path = file_of(first); error.starts_with(path))
            error.replace(0, path.size(), file_of(twin));
        twin.reading->load_error = std::move(error);
        finish(twin);
    }
    hand_over();
}

void IsolatedIndex::tick() {
    if (finished_.size() >= kBlockFiles || seconds_since(handed_over_) > kBlockSeconds) hand_over();
}

void IsolatedIndex::hand_over() {
    handed_over_ = std::chrono::steady_clock::now();
    if (finished_.empty()) return;
    build_->hand_over(finished_);
    finished_.clear();
}

}  // namespace ricci::app
