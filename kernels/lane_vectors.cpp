#include "kernels/lane_vectors.h"

#include <algorithm>
#include <cmath>

#include "kernels/instruction_set.h"
#include "kernels/instruction_targets.h"
#include "kernels/vector_math.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

RICCI_ALWAYS_INLINE LaneRow<double> round_rows(const LaneArray<double>& values, std::size_t rows,
                                               LaneArray<float>& rounded) {
    LaneRow<double> largest{};
    for (std::size_t r = 0; r < rows; ++r) {
        const double* in = values[r].lane;
        float* out = rounded[r].lane;
#pragma omp simd
        for (int l = 0; l < kLanes; ++l) {
            out[l] = static_cast<float>(in[l]);
            const double size = std::abs(in[l]);
            // A NaN stays: no comparison with it holds.
            largest.lane[l] = size <= largest.lane[l] ? largest.lane[l] : size;
        }
        // … and is not overtaken.
#pragma omp simd
        for (int l = 0; l < kLanes; ++l) largest.lane[l] += 0.0 * in[l];
    }
    return largest;
}

/// Rows summed in single precision before a sum goes on in double.
constexpr std::size_t kRun = 32;

template <std::size_t depth>
RICCI_ALWAYS_INLINE void products(std::size_t rows, const LaneArray<float>& right,
                                  const LaneArray<float>& right_before, const LaneArray<float>& solution,
                                  const LaneArray<float>& solution_before, LaneHistory& history,
                                  LaneProducts& out) {
    std::array<const LaneRow<float>*, depth> change;
    for (std::size_t a = 0; a < depth; ++a) change[a] = history.right[a].data();
    LaneRow<float>* newest = depth > 0 ? history.right[0].data() : nullptr;
    for (std::size_t begin = 0; begin < rows; begin += kRun) {
        const std::size_t end = std::min(rows, begin + kRun);
        LaneRow<float> run[depth + 2] = {};
        for (std::size_t r = begin; r < end; ++r) {
            const float* f = solution[r].lane;
            if constexpr (depth > 0) {
                const float *before = solution_before[r].lane, *r1 = right[r].lane,
                            *r0 = right_before[r].lane;
                float* dr = newest[r].lane;
#pragma omp simd
                for (int l = 0; l < kLanes; ++l) {
                    const float d = r1[l] - r0[l];
                    dr[l] = d;
                    run[depth].lane[l] += d * before[l];
                    run[0].lane[l] += d * f[l];
                }
            }
            for (std::size_t a = 1; a < depth; ++a) {
                const float* c = change[a][r].lane;
#pragma omp simd
                for (int l = 0; l < kLanes; ++l) run[a].lane[l] += c[l] * f[l];
            }
#pragma omp simd
            for (int l = 0; l < kLanes; ++l) run[depth + 1].lane[l] += f[l];
        }
        const auto add = [](LaneRow<double>& sum, const LaneRow<float>& part) {
            for (int l = 0; l < kLanes; ++l) sum.lane[l] += static_cast<double>(part.lane[l]);
        };
        for (std::size_t a = 0; a < depth; ++a) add(out.change[a], run[a]);
        add(out.newest_before, run[depth]);
        add(out.sum, run[depth + 1]);
    }
}

struct StepArguments {
    LaneRow<float> keep;  // 1 in active lanes
    LaneRow<float> mean;
    std::array<LaneRow<float>, kLaneHistory> weight;
};

template <std::size_t depth>
RICCI_ALWAYS_INLINE void steps(std::size_t rows, const StepArguments& arguments,
                               const LaneArray<float>& solution, const LaneArray<float>& solution_before,
                               LaneHistory& history, LaneArray<float>& step, LaneArray<double>& u) {
    std::array<const LaneRow<float>*, depth> change;
    for (std::size_t a = 0; a < depth; ++a) change[a] = history.point[a].data();
    LaneRow<float>* newest = depth > 0 ? history.point[0].data() : nullptr;
    for (std::size_t r = 0; r < rows; ++r) {
        const float *f = solution[r].lane, *before = solution_before[r].lane;
        float* s = step[r].lane;
        double* x = u[r].lane;
        LaneRow<float> next;
        if constexpr (depth > 0) {
            float* y = newest[r].lane;
#pragma omp simd
            for (int l = 0; l < kLanes; ++l) {
                y[l] = s[l] + (f[l] - before[l]);
                next.lane[l] = (f[l] - arguments.mean.lane[l]) - arguments.weight[0].lane[l] * y[l];
            }
        } else {
#pragma omp simd
            for (int l = 0; l < kLanes; ++l) next.lane[l] = f[l] - arguments.mean.lane[l];
        }
        for (std::size_t a = 1; a < depth; ++a) {
            const float* c = change[a][r].lane;
#pragma omp simd
            for (int l = 0; l < kLanes; ++l) next.lane[l] -= arguments.weight[a].lane[l] * c[l];
        }
#pragma omp simd
        for (int l = 0; l < kLanes; ++l) {
            const float taken = arguments.keep.lane[l] != 0.0F ? next.lane[l] : 0.0F;
            s[l] = taken;
            x[l] += static_cast<double>(taken);
        }
    }
}

/// Runs `call<depth>(...)` with the depth as a constant.
#define RICCI_WITH_DEPTH(depth, call, ...)   \
    switch (depth) {                         \
        case 0:                              \
            call<0>(__VA_ARGS__);            \
            break;                           \
        case 1:                              \
            call<1>(__VA_ARGS__);            \
            break;                           \
        case 2:                              \
            call<2>(__VA_ARGS__);            \
            break;                           \
        case 3:                              \
            call<3>(__VA_ARGS__);            \
            break;                           \
        case 4:                              \
            call<4>(__VA_ARGS__);            \
            break;                           \
        case 5:                              \
            call<5>(__VA_ARGS__);            \
            break;                           \
        default:                             \
            call<kLaneHistory>(__VA_ARGS__); \
            break;                           \
    }

// One set of entry points per instruction set.
#define RICCI_TARGET_baseline
#define RICCI_TARGET_avx2 RICCI_AVX2
#define RICCI_TARGET_avx512 RICCI_AVX512
#define RICCI_LANE_VECTORS(name)                                                                            \
    RICCI_TARGET_##name LaneRow<double> round_##name(const LaneArray<double>& values, std::size_t rows,     \
                                                     LaneArray<float>& rounded) {                           \
        return round_rows(values, rows, rounded);                                                           \
    }                                                                                                       \
    RICCI_TARGET_##name void products_##name(                                                               \
        std::size_t depth, std::size_t rows, const LaneArray<float>& right,                                 \
        const LaneArray<float>& right_before, const LaneArray<float>& solution,                             \
        const LaneArray<float>& solution_before, LaneHistory& history, LaneProducts& out){RICCI_WITH_DEPTH( \
        depth, products, rows, right, right_before, solution, solution_before, history,                     \
        out)} RICCI_TARGET_##name void steps_##name(std::size_t depth, std::size_t rows,                    \
                                                    const StepArguments& arguments,                         \
                                                    const LaneArray<float>& solution,                       \
                                                    const LaneArray<float>& solution_before,                \
                                                    LaneHistory& history, LaneArray<float>& step,           \
                                                    LaneArray<double>& u) {                                 \
        RICCI_WITH_DEPTH(depth, steps, rows, arguments, solution, solution_before, history, step, u)        \
    }
RICCI_LANE_VECTORS(baseline)
#ifdef RICCI_LANE_TARGETS
RICCI_LANE_VECTORS(avx2)
RICCI_LANE_VECTORS(avx512)
#endif
#undef RICCI_LANE_VECTORS
#undef RICCI_WITH_DEPTH

template <class Baseline, class Avx2, class Avx512>
auto chosen(Baseline baseline, [[maybe_unused]] Avx2 avx2, [[maybe_unused]] Avx512 avx512) {
    switch (instruction_set()) {
        case InstructionSet::avx512:
            return avx512;
        case InstructionSet::avx2:
            return avx2;
        case InstructionSet::baseline:
            break;
    }
    return baseline;
}

#ifdef RICCI_LANE_TARGETS
#define RICCI_CHOSEN(function) chosen(function##_baseline, function##_avx2, function##_avx512)
#else
#define RICCI_CHOSEN(function) function##_baseline
#endif

}  // namespace

void lane_broadcast(std::span<const double> base, LaneArray<double>& out) {
    for (std::size_t r = 0; r < base.size(); ++r) std::fill_n(out[r].lane, kLanes, base[r]);
}

LaneRow<double> lane_round(const LaneArray<double>& values, Index rows, LaneArray<float>& rounded) {
    return RICCI_CHOSEN(round)(values, at(rows), rounded);
}

LaneProducts lane_products(Index rows, const LaneArray<float>& right, const LaneArray<float>& right_before,
                           const LaneArray<float>& solution, const LaneArray<float>& solution_before,
                           LaneHistory& history) {
    LaneProducts out{};
    RICCI_CHOSEN(products)
    (history.right.size(), at(rows), right, right_before, solution, solution_before, history, out);
    return out;
}

void lane_step(Index rows, LaneMask active, const LaneArray<float>& solution,
               const LaneArray<float>& solution_before, const LaneRow<float>& mean,
               std::span<const LaneRow<float>> weight, LaneHistory& history, LaneArray<float>& step,
               LaneArray<double>& u) {
    StepArguments arguments{};
    for (int l = 0; l < kLanes; ++l) arguments.keep.lane[l] = ((active >> l) & 1) != 0 ? 1.0F : 0.0F;
    arguments.mean = mean;
    std::copy(weight.begin(), weight.end(), arguments.weight.begin());
    RICCI_CHOSEN(steps)
    (history.point.size(), at(rows), arguments, solution, solution_before, history, step, u);
}

}  // namespace ricci
