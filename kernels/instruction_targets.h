// Function attributes that compile one text for several instruction sets. Include only from the .cpp of a
// kernel.
#pragma once

#if defined(__GNUC__) && defined(__x86_64__)
#define RICCI_LANE_TARGETS 1
#define RICCI_AVX2 __attribute__((target("avx2,fma")))
#ifdef __clang__
#define RICCI_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma")))
#else
#define RICCI_AVX512 \
    __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,prefer-vector-width=512")))
#endif
#endif
