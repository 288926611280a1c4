// The two sweeps of LaneFactor::solve, included once per instruction set (hence no guard). The including file
// defines, in the same namespace, kWidest and Row (kLanes numbers in registers) with load, store, zero, add
// and subtract_product, kAhead, RICCI_SWEEP (makes a function inline for the instruction set) and
// RICCI_SWEEP_ENTRY (compiles one for it).

/// Panels of as many columns as there are J: the columns' rows stay in registers throughout.
template <class Columns>
struct Sweep;

template <int... J>
struct Sweep<std::integer_sequence<int, J...>> {
    static constexpr int kWidth = sizeof...(J);

    RICCI_SWEEP static void forward_row(const Row (&top)[kWidth], const float* m, float* y) {
        Row sum = load(y);
        ((sum = subtract_product(sum, m[J], top[J])), ...);
        store(y, sum);
    }

    RICCI_SWEEP static void forward_pair(const Row (&top)[kWidth], const float* m, float* y0, float* y1) {
        Row sum0 = load(y0), sum1 = load(y1);
        ((sum0 = subtract_product(sum0, m[J], top[J]), sum1 = subtract_product(sum1, m[kWidth + J], top[J])),
         ...);
        store(y0, sum0);
        store(y1, sum1);
    }

    /// y_2 -= M y_1. `m`: the panel's M; moves on to the next panel's.
    RICCI_SWEEP static void forward(const LanePanel& panel, const float*& m, const std::uint32_t* row,
                                    float* block) {
        row += panel.row_begin;
        Row top[kWidth] = {load(block + row[0] + J * kLanes)...};
        row += kWidth;
        Index i = 0;
        for (; i + 1 < panel.height; i += 2, m += 2 * kWidth) {
            __builtin_prefetch(m + kAhead);
            if constexpr (kWidth > 8) __builtin_prefetch(m + kAhead + kWidth);
            forward_pair(top, m, block + row[i], block + row[i + 1]);
        }
        if (i < panel.height) {
            forward_row(top, m, block + row[i]);
            m += kWidth;
        }
    }

    RICCI_SWEEP static void backward_row(Row (&sum)[kWidth], const float* m, const float* x) {
        const Row value = load(x);
        ((sum[J] = subtract_product(sum[J], m[J], value)), ...);
    }

    /// x_1 = S y_1 - M^T x_2, rows in kWays groups whose sums do not wait for each other. `m`, `s`: ends of
    /// the panel's M and -S; move back to their beginnings.
    RICCI_SWEEP static void backward(const LanePanel& panel, const float*& m, const float*& s,
                                     const std::uint32_t* row, float* block) {
        constexpr int kWays = kWidth * 2 > kWidest ? 1 : kWidth * 4 > kWidest ? 2 : 4;
        m -= static_cast<std::ptrdiff_t>(panel.height) * kWidth;
        s -= kWidth * kWidth;
        row += panel.row_begin;
        float* own = block + row[0];
        Row sum[kWays][kWidth];
        for (auto& way : sum) ((way[J] = zero()), ...);
        for (int i = 0; i < kWidth; ++i) {
            __builtin_prefetch(s + i * kWidth - kAhead);
            backward_row(sum[i % kWays], s + i * kWidth, own + i * kLanes);
        }
        row += kWidth;
        const float* from = m;
        Index i = 0;
        for (; i + kWays <= panel.height; i += kWays, from += kWays * kWidth) {
            __builtin_prefetch(from - kAhead);
            backward_row(sum[0], from, block + row[i]);
            if constexpr (kWays > 1) backward_row(sum[1], from + kWidth, block + row[i + 1]);
            if constexpr (kWays > 2) backward_row(sum[2], from + 2 * kWidth, block + row[i + 2]);
            if constexpr (kWays > 2) backward_row(sum[3], from + 3 * kWidth, block + row[i + 3]);
        }
        for (; i < panel.height; ++i, from += kWidth) backward_row(sum[0], from, block + row[i]);
        if constexpr (kWays > 2) {
            ((sum[0][J] = add(sum[0][J], sum[2][J])), ...);
            ((sum[1][J] = add(sum[1][J], sum[3][J])), ...);
        }
        if constexpr (kWays > 1) ((sum[0][J] = add(sum[0][J], sum[1][J])), ...);
        (store(own + J * kLanes, sum[0][J]), ...);
    }
};

#define RICCI_EACH_WIDTH(sweep)    \
    switch (panel.width) {         \
        RICCI_ONE_WIDTH(sweep, 1)  \
        RICCI_ONE_WIDTH(sweep, 2)  \
        RICCI_ONE_WIDTH(sweep, 3)  \
        RICCI_ONE_WIDTH(sweep, 4)  \
        RICCI_ONE_WIDTH(sweep, 5)  \
        RICCI_ONE_WIDTH(sweep, 6)  \
        RICCI_ONE_WIDTH(sweep, 7)  \
        RICCI_ONE_WIDTH(sweep, 8)  \
        RICCI_ONE_WIDTH(sweep, 9)  \
        RICCI_ONE_WIDTH(sweep, 10) \
        RICCI_ONE_WIDTH(sweep, 11) \
        RICCI_ONE_WIDTH(sweep, 12) \
        RICCI_ONE_WIDTH(sweep, 13) \
        RICCI_ONE_WIDTH(sweep, 14) \
        RICCI_ONE_WIDTH(sweep, 15) \
        RICCI_ONE_WIDTH(sweep, 16) \
        default:                   \
            break;                 \
    }
#define RICCI_ONE_WIDTH(sweep, columns)                                                           \
    case columns:                                                                                 \
        if constexpr (columns <= kWidest) Sweep<std::make_integer_sequence<int, columns>>::sweep; \
        break;

RICCI_SWEEP_ENTRY void sweeps(std::span<const LanePanel> panels, const float* m, const float* s,
                              const std::uint32_t* row, float* block) {
    for (const LanePanel *p = panels.data(), *end = p + panels.size(); p != end; ++p) {
        const LanePanel& panel = *p;
        RICCI_EACH_WIDTH(forward(panel, m, row, block))
    }
    for (const LanePanel *begin = panels.data(), *p = begin + panels.size(); p != begin;) {
        const LanePanel& panel = *--p;
        RICCI_EACH_WIDTH(backward(panel, m, s, row, block))
    }
}
#undef RICCI_EACH_WIDTH
#undef RICCI_ONE_WIDTH
