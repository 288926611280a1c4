#include "engine/python/long_call.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <string>
#include <thread>

#include "engine/flow/cancellation.h"

// OpenBLAS's own; absent where another BLAS is linked.
extern "C" {
void openblas_set_num_threads(int threads) __attribute__((weak));
int openblas_get_num_threads() __attribute__((weak));
int openblas_get_parallel() __attribute__((weak));
}

namespace py = pybind11;

namespace ricci::python {
namespace {

struct Message {
    int level = 0;  // Python's
    std::string text;
};

/// Messages wait here until a thread that holds the interpreter's lock fetches them: the engine's threads
/// must not wait for it.
class WaitingMessages final : public spdlog::sinks::base_sink<std::mutex> {
  public:
    std::deque<Message> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(waiting_, {});
    }

  protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        if (waiting_.size() == kMostWaiting) waiting_.pop_front();
        waiting_.push_back({python_level(message.level), {message.payload.data(), message.payload.size()}});
    }
    void flush_() override {}

  private:
    static constexpr std::size_t kMostWaiting = 10000;
    static int python_level(spdlog::level::level_enum level) {
        switch (level) {
            case spdlog::level::err:
            case spdlog::level::critical:
                return 40;
            case spdlog::level::warn:
                return 30;
            case spdlog::level::info:
                return 20;
            default:
                return 10;
        }
    }
    std::deque<Message> waiting_;
};

std::shared_ptr<WaitingMessages>& messages() {
    static auto sink = std::make_shared<WaitingMessages>();
    return sink;
}

void hand_over_messages() {
    const std::deque<Message> waiting = messages()->take();
    if (waiting.empty()) return;
    const py::object log = py::module_::import("logging").attr("getLogger")("ricci").attr("log");
    for (const Message& m : waiting) log(m.level, "%s", m.text);
}

py::object to_python(const Progress& progress) {
    const py::module_ types = py::module_::import("ricci._progress");
    if (const auto* p = std::get_if<SchedulerProgress>(&progress))
        return types.attr("SweepProgress")(p->sources_opened, p->sources, p->solves_done, p->solves_known,
                                           p->seconds);
    const auto& line = std::get<IterationLog>(progress);
    return types.attr("FlowProgress")(line.iteration, line.residual_max, line.step, line.flips, line.seconds);
}

/// What the calling thread does now and then, with the interpreter's lock. Raises.
void attend(Call& call, const py::object& progress) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    hand_over_messages();
    if (progress.is_none()) return;
    if (const auto latest = call.take_progress()) progress(to_python(*latest));
}

/// The engine's workers are the threads. The calls of one process overlap where Python has threads; the last
/// one gives NumPy's OpenBLAS its threads back.
class SerialBlas {
  public:
    SerialBlas() {
        const std::lock_guard lock(mutex());
        if (users()++ > 0 || openblas_set_num_threads == nullptr || openblas_get_num_threads == nullptr)
            return;
        before() = openblas_get_num_threads();
        openblas_set_num_threads(1);
    }
    ~SerialBlas() {
        const std::lock_guard lock(mutex());
        if (--users() == 0 && before() > 1) openblas_set_num_threads(std::exchange(before(), 0));
    }
    SerialBlas(const SerialBlas&) = delete;
    SerialBlas& operator=(const SerialBlas&) = delete;

  private:
    static std::mutex& mutex() {
        static std::mutex m;
        return m;
    }
    static int& users() {
        static int count = 0;
        return count;
    }
    static int& before() {
        static int threads = 0;
        return threads;
    }
};

}  // namespace

void Call::report(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    latest_ = progress;
}

std::optional<Progress> Call::take_progress() {
    const std::lock_guard lock(mutex_);
    return std::exchange(latest_, std::nullopt);
}

void run_call(const py::object& progress, const std::function<void(Call&)>& work) {
    Call call;
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
    std::exception_ptr failure;
    std::optional<py::error_already_set> raised;
    const SerialBlas serial;
    std::thread worker([&] {
        try {
            const CancellationScope scope(call.stop());
            work(call);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex);
        done = true;
        changed.notify_one();
    });
    for (bool finished = false; !finished;) {
        {
            const py::gil_scoped_release free;
            std::unique_lock lock(mutex);
            finished = changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; });
        }
        if (raised) continue;
        try {
            attend(call, progress);
        } catch (py::error_already_set& error) {
            raised = std::move(error);
            call.end();
        }
    }
    worker.join();
    if (raised) throw std::move(*raised);
    if (failure) std::rethrow_exception(failure);
}

void set_up_log() {
    auto logger = std::make_shared<spdlog::logger>("ricci", messages());
    logger->set_level(spdlog::level::debug);
    spdlog::set_default_logger(logger);
}

bool blas_is_safe() {
    constexpr int kSequential = 0;
    return openblas_get_parallel == nullptr || openblas_get_parallel() != kSequential;
}

}  // namespace ricci::python
