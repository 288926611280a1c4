// Time as the benchmarks measure it: of this thread (steady on a busy machine), of the process, and on the
// wall.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace ricci::bench {

/// Processor seconds of the calling thread.
inline double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Processor seconds of all threads of this process.
inline double process_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Seconds of a whole process.
struct Cost {
    double wall = 0.0, processor = 0.0;
};

template <class F>
Cost cost_of(F&& f) {
    const double wall = wall_seconds(), processor = process_seconds();
    f();
    return {wall_seconds() - wall, process_seconds() - processor};
}

/// Repeated measurements of one thing.
struct Samples {
    std::vector<double> thread, wall;

    template <class F>
    void measure(F&& f) {
        const double wall_start = wall_seconds(), thread_start = thread_seconds();
        f();
        thread.push_back(thread_seconds() - thread_start);
        wall.push_back(wall_seconds() - wall_start);
    }
};

/// The middle one (the upper of two). `values` is not empty.
inline double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace ricci::bench
