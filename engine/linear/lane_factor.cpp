#include "engine/linear/lane_factor.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>
#define RICCI_HAS_TARGETS
#endif

namespace ricci {
namespace {

std::size_t at(std::int64_t i) {
    return static_cast<std::size_t>(i);
}

/// Numbers between what a sweep reads and what it asks the caches for.
constexpr std::ptrdiff_t kAhead = 1024;

// ---- Rows of lanes in registers. kWidest: as many columns' rows as leave registers for sums. ----

namespace baseline {

#define RICCI_SWEEP inline
#define RICCI_SWEEP_ENTRY
constexpr int kWidest = 4;
using Row = LaneRow<float>;

inline Row load(const float* from) {
    Row row;
    std::copy_n(from, kLanes, row.lane);
    return row;
}
inline void store(float* to, const Row& row) {
    std::copy_n(row.lane, kLanes, to);
}
inline Row zero() {
    return {};
}
inline Row add(const Row& a, const Row& b) {
    Row sum;
    for (int l = 0; l < kLanes; ++l) sum.lane[l] = a.lane[l] + b.lane[l];
    return sum;
}
inline Row subtract_product(const Row& a, float m, const Row& b) {
    Row sum;
    for (int l = 0; l < kLanes; ++l) sum.lane[l] = a.lane[l] - m * b.lane[l];
    return sum;
}
#include "engine/linear/lane_sweeps.inl"
#undef RICCI_SWEEP
#undef RICCI_SWEEP_ENTRY

}  // namespace baseline

#ifdef RICCI_HAS_TARGETS

namespace avx2 {

#define RICCI_SWEEP_ENTRY __attribute__((target("avx2,fma")))
#define RICCI_SWEEP __attribute__((always_inline, target("avx2,fma"))) inline
constexpr int kWidest = 4;
struct Row {
    __m256 low, high;
};
RICCI_SWEEP Row load(const float* from) {
    return {_mm256_loadu_ps(from), _mm256_loadu_ps(from + 8)};
}
RICCI_SWEEP void store(float* to, Row row) {
    _mm256_storeu_ps(to, row.low);
    _mm256_storeu_ps(to + 8, row.high);
}
RICCI_SWEEP Row zero() {
    return {_mm256_setzero_ps(), _mm256_setzero_ps()};
}
RICCI_SWEEP Row add(Row a, Row b) {
    return {_mm256_add_ps(a.low, b.low), _mm256_add_ps(a.high, b.high)};
}
RICCI_SWEEP Row subtract_product(Row a, float m, Row b) {
    const __m256 all = _mm256_set1_ps(m);
    return {_mm256_fnmadd_ps(all, b.low, a.low), _mm256_fnmadd_ps(all, b.high, a.high)};
}
#include "engine/linear/lane_sweeps.inl"
#undef RICCI_SWEEP
#undef RICCI_SWEEP_ENTRY

}  // namespace avx2

namespace avx512 {

#define RICCI_SWEEP_ENTRY __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma")))
#define RICCI_SWEEP \
    __attribute__((always_inline, target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma"))) inline
constexpr int kWidest = 16;
struct Row {
    __m512 all;
};
RICCI_SWEEP Row load(const float* from) {
    return {_mm512_loadu_ps(from)};
}
RICCI_SWEEP void store(float* to, Row row) {
    _mm512_storeu_ps(to, row.all);
}
RICCI_SWEEP Row zero() {
    return {_mm512_setzero_ps()};
}
RICCI_SWEEP Row add(Row a, Row b) {
    return {_mm512_add_ps(a.all, b.all)};
}
RICCI_SWEEP Row subtract_product(Row a, float m, Row b) {
    return {_mm512_fnmadd_ps(_mm512_set1_ps(m), b.all, a.all)};
}
#include "engine/linear/lane_sweeps.inl"
#undef RICCI_SWEEP
#undef RICCI_SWEEP_ENTRY

}  // namespace avx512

/// Operations on denormal numbers take a hundred times as long: none are made while this lives.
class FlushDenormals {
  public:
    FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
    ~FlushDenormals() { _mm_setcsr(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
    unsigned before_;
};

#else

struct FlushDenormals {};

#endif  // RICCI_HAS_TARGETS

int widest_panel(InstructionSet set) {
#ifdef RICCI_HAS_TARGETS
    if (set == InstructionSet::avx512) return avx512::kWidest;
    if (set == InstructionSet::avx2) return avx2::kWidest;
#endif
    static_cast<void>(set);
    return baseline::kWidest;
}

// ---- From the supernodes to the panels. ----

void validate(const SupernodalFactor& f) {
    const std::int64_t n = static_cast<std::int64_t>(f.permutation.size());
    const std::size_t bounds = f.first_column.size();
    bool sound = bounds > 0 && f.row_begin.size() == bounds && f.value_begin.size() == bounds &&
                 f.first_column.front() == 0 && f.first_column.back() == n &&
                 n < std::numeric_limits<std::uint32_t>::max() / kLanes &&
                 f.row.size() <= std::numeric_limits<std::uint32_t>::max();
    for (std::size_t s = 0; sound && s + 1 < bounds; ++s) {
        const std::int64_t columns = f.first_column[s + 1] - f.first_column[s];
        const std::int64_t rows = f.row_begin[s + 1] - f.row_begin[s];
        sound = columns > 0 && rows >= columns && f.row_begin[s] >= 0 &&
                f.row_begin[s + 1] <= static_cast<std::int64_t>(f.row.size()) && f.value_begin[s] >= 0 &&
                f.value_begin[s] + rows * columns <= static_cast<std::int64_t>(f.value.size());
        for (std::int64_t i = 0; sound && i < rows; ++i) {
            const Index row = f.row[at(f.row_begin[s] + i)];
            sound = i < columns ? row == f.first_column[s] + i
                                : row > f.row[at(f.row_begin[s] + i - 1)] && row < n;
        }
    }
    if (!sound) throw std::invalid_argument("a supernodal factor whose arrays do not fit together");
}

/// Columns [0, width) and rows [0, width + height) of L from `corner`, column by column.
struct PanelOfL {
    const double* corner;
    std::int64_t stride, width, height;

    [[nodiscard]] double operator()(std::int64_t i, std::int64_t j) const { return corner[j * stride + i]; }
};

/// L_11^-1 [row][column], lower triangle.
void invert_triangle(const PanelOfL& l, std::vector<double>& inverse) {
    const std::int64_t w = l.width;
    inverse.assign(at(w * w), 0.0);
    for (std::int64_t j = 0; j < w; ++j) {
        if (!(l(j, j) > 0.0)) throw std::invalid_argument("a factor with a diagonal entry not positive");
        inverse[at(j * w + j)] = 1.0 / l(j, j);
        for (std::int64_t i = j + 1; i < w; ++i) {
            double sum = 0.0;
            for (std::int64_t k = j; k < i; ++k) sum += l(i, k) * inverse[at(k * w + j)];
            inverse[at(i * w + j)] = -sum / l(i, i);
        }
    }
}

/// Appends -S and M.
void append_entries(const PanelOfL& l, std::vector<double>& inverse, std::vector<float>& diagonal,
                    std::vector<float>& below) {
    const std::int64_t w = l.width;
    invert_triangle(l, inverse);
    for (std::int64_t i = 0; i < w; ++i)
        for (std::int64_t j = 0; j < w; ++j) {
            double sum = 0.0;
            for (std::int64_t k = std::max(i, j); k < w; ++k)
                sum += inverse[at(k * w + i)] * inverse[at(k * w + j)];
            diagonal.push_back(static_cast<float>(-sum));
        }
    for (std::int64_t i = w; i < w + l.height; ++i)
        for (std::int64_t j = 0; j < w; ++j) {
            double sum = 0.0;
            for (std::int64_t k = j; k < w; ++k) sum += l(i, k) * inverse[at(k * w + j)];
            below.push_back(static_cast<float>(sum));
        }
}

}  // namespace

LaneFactor::LaneFactor(const SupernodalFactor& factor, InstructionSet set)
    : permutation_(factor.permutation), sweeps_(baseline::sweeps) {
    validate(factor);
#ifdef RICCI_HAS_TARGETS
    if (set == InstructionSet::avx512) sweeps_ = avx512::sweeps;
    if (set == InstructionSet::avx2) sweeps_ = avx2::sweeps;
#endif
    const std::int64_t widest = widest_panel(set);
    std::vector<double> inverse;
    for (std::size_t s = 0; s + 1 < factor.first_column.size(); ++s) {
        const std::int64_t columns = factor.first_column[s + 1] - factor.first_column[s];
        const std::int64_t rows = factor.row_begin[s + 1] - factor.row_begin[s];
        const auto row_begin = static_cast<std::int64_t>(row_.size());
        for (std::int64_t i = 0; i < rows; ++i)
            row_.push_back(kLanes * static_cast<std::uint32_t>(factor.row[at(factor.row_begin[s] + i)]));
        const std::int64_t panels = (columns + widest - 1) / widest;
        for (std::int64_t p = 0; p < panels; ++p) {
            const std::int64_t begin = columns * p / panels, end = columns * (p + 1) / panels;
            const PanelOfL l{factor.value.data() + factor.value_begin[s] + begin * rows + begin, rows,
                             end - begin, rows - end};
            panels_.push_back({static_cast<std::uint32_t>(row_begin + begin), static_cast<Index>(l.width),
                               static_cast<Index>(l.height)});
            append_entries(l, inverse, diagonal_, below_);
        }
        entries_ += columns * rows - columns * (columns - 1) / 2;
    }
    panels_.shrink_to_fit();
    row_.shrink_to_fit();
    below_.shrink_to_fit();
    diagonal_.shrink_to_fit();
}

void LaneFactor::solve(LaneArray<float>& block) const {
    if (permutation_.empty()) return;
    [[maybe_unused]] const FlushDenormals flush;
    sweeps_(panels_, below_.data(), diagonal_.data() + diagonal_.size(), row_.data(), block.front().lane);
}

std::int64_t LaneFactor::bytes() const {
    return static_cast<std::int64_t>(
        permutation_.size() * sizeof(Index) + panels_.size() * sizeof(LanePanel) +
        row_.size() * sizeof(std::uint32_t) + (below_.size() + diagonal_.size()) * sizeof(float));
}

}  // namespace ricci
