#pragma once

#include <cstring>

#ifdef __FMA__
#include <immintrin.h>
#endif

namespace umtet::simd {

// Compiler vector types are used because Eigen's have no casts between vectors of four numbers of different types, and
// no rests of two.
using Pack4d = double __attribute__((vector_size(32)));
using Pack4i = int __attribute__((vector_size(16)));

/// Loads four consecutive numbers.
inline Pack4d four(const double* a) { return Pack4d{a[0], a[1], a[2], a[3]}; }
inline Pack4d four(const float* a) { return Pack4d{a[0], a[1], a[2], a[3]}; }
/// a0 a1 b0 b1
inline Pack4d two_and_two(const double* a, const double* b) { return Pack4d{a[0], a[1], b[0], b[1]}; }
inline Pack4d two_and_two(const float* a, const float* b) {
  // Pairs are loaded as one eight-byte number each: two instructions, where four floats take seven.
  using Pack2d = double __attribute__((vector_size(16)));
  using Pack4f = float __attribute__((vector_size(16)));
  double pair[2];
  std::memcpy(pair, a, sizeof(double)), std::memcpy(pair + 1, b, sizeof(double));
  const auto f = (Pack4f)Pack2d{pair[0], pair[1]};
  return Pack4d{f[0], f[1], f[2], f[3]};
}

/// Four copies of a number.
inline Pack4d all(double a) { return Pack4d{a, a, a, a}; }
/// a b + c, rounded once if the target machine supports it.
inline Pack4d fused(Pack4d a, Pack4d b, Pack4d c) {
#ifdef __FMA__
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

inline Pack4i truncated(Pack4d a) { return __builtin_convertvector(a, Pack4i); }
inline Pack4d as_doubles(Pack4i a) {
  return Pack4d{static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2]),
                static_cast<double>(a[3])};
}
template <class V>
V least(V a, V b) {
  return a < b ? a : b;
}
template <class V>
V most(V a, V b) {
  return a > b ? a : b;
}

}  // namespace umtet::simd
