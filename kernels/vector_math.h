// Lets GCC vectorise loops over atan2 and exp with glibc's libmvec (4 ulp) without fast-math, and builds a
// kernel once per instruction set with run-time dispatch. Include only from the .cpp of a kernel.
#pragma once

#include <cmath>

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
extern "C" {
#pragma omp declare simd notinbranch
double atan2(double, double) noexcept;
#pragma omp declare simd notinbranch
double exp(double) noexcept;
}
#endif

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(RICCI_NO_CLONES)
#define RICCI_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define RICCI_VECTOR_CLONES
#endif
#define RICCI_ALWAYS_INLINE __attribute__((always_inline)) inline

namespace ricci {

/// Faces per block of a kernel: its scratch arrays stay in the first-level cache. Every loop runs over a
/// multiple of kVectorPad lanes, padded with equilateral triangles, so that no face ever meets a scalar
/// remainder loop (whose atan2 rounds differently): a face's bits do not depend on where blocks begin.
inline constexpr int kFaceBlock = 128;
inline constexpr int kVectorPad = 8;

}  // namespace ricci
