#pragma once
/// Between numbers that lie point by point (x y z side by side) and lanes (eight x, eight y, eight z): whole registers are moved and shuffled, where picking numbers one by one
/// would cost more than the arithmetic on them. Kernel units only.
#include "supple/math/lanes.h"

#if !defined(SUPPLE_SCALAR_LANES) && defined(__AVX2__)
#include <immintrin.h>
#endif

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

#if !defined(SUPPLE_SCALAR_LANES) && defined(__AVX512F__) && defined(__AVX512VL__)

/// x y z of the points id[lane], a point being three numbers of `field`.
inline void load_points(const double* field, const std::int32_t* id, Lanes& x, Lanes& y, Lanes& z) {
    const auto at = [&](int lane) { return _mm256_maskz_loadu_pd(7, field + 3 * std::ptrdiff_t(id[lane])); };  // reads nothing past the point
    const auto pair = [&](int lane) { return _mm512_insertf64x4(_mm512_castpd256_pd512(at(lane)), at(lane + 4), 1); };
    const __m512d a = pair(0), b = pair(1), c = pair(2), d = pair(3);
    const __m512d xz01 = _mm512_unpacklo_pd(a, b), y01 = _mm512_unpackhi_pd(a, b), xz23 = _mm512_unpacklo_pd(c, d), y23 = _mm512_unpackhi_pd(c, d);
    const __m512i low = _mm512_set_epi64(13, 12, 5, 4, 9, 8, 1, 0), high = _mm512_set_epi64(15, 14, 7, 6, 11, 10, 3, 2);
    x = _mm512_permutex2var_pd(xz01, low, xz23);
    y = _mm512_permutex2var_pd(y01, low, y23);
    z = _mm512_permutex2var_pd(xz01, high, xz23);
}

/// Lanes 0 2, 4 6, 1 3 and 5 7 of four fields, point by point.
inline void to_points(const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w, __m512d out[4]) {
    const __m512d xy_even = _mm512_unpacklo_pd(x, y), xy_odd = _mm512_unpackhi_pd(x, y), zw_even = _mm512_unpacklo_pd(z, w), zw_odd = _mm512_unpackhi_pd(z, w);
    const __m512i low = _mm512_set_epi64(11, 10, 3, 2, 9, 8, 1, 0), high = _mm512_set_epi64(15, 14, 7, 6, 13, 12, 5, 4);
    out[0] = _mm512_permutex2var_pd(xy_even, low, zw_even);
    out[1] = _mm512_permutex2var_pd(xy_even, high, zw_even);
    out[2] = _mm512_permutex2var_pd(xy_odd, low, zw_odd);
    out[3] = _mm512_permutex2var_pd(xy_odd, high, zw_odd);
}
inline constexpr int kLaneOf[4][2] = {{0, 2}, {4, 6}, {1, 3}, {5, 7}};

/// x y z w of every lane, side by side at out + lane * stride. Aligned to a point.
inline void store_points(double* out, std::size_t stride, const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w) {
    __m512d p[4];
    to_points(x, y, z, w, p);
    for (int i = 0; i < 4; ++i) {
        _mm256_store_pd(out + std::size_t(kLaneOf[i][0]) * stride, _mm512_castpd512_pd256(p[i]));
        _mm256_store_pd(out + std::size_t(kLaneOf[i][1]) * stride, _mm512_extractf64x4_pd(p[i], 1));
    }
}
inline void store_points(float* out, std::size_t stride, Floats x, Floats y, Floats z, Floats w) {
    const __m256 a = __m256(x), b = __m256(y), c = __m256(z), d = __m256(w);
    const __m256 ab_low = _mm256_unpacklo_ps(a, b), ab_high = _mm256_unpackhi_ps(a, b), cd_low = _mm256_unpacklo_ps(c, d), cd_high = _mm256_unpackhi_ps(c, d);
    const __m256 two[4] = {_mm256_shuffle_ps(ab_low, cd_low, 0x44), _mm256_shuffle_ps(ab_low, cd_low, 0xee), _mm256_shuffle_ps(ab_high, cd_high, 0x44),
                           _mm256_shuffle_ps(ab_high, cd_high, 0xee)};  // lanes 0 4, 1 5, 2 6, 3 7
    for (std::size_t lane = 0; lane < 4; ++lane) {
        _mm_store_ps(out + lane * stride, _mm256_castps256_ps128(two[lane]));
        _mm_store_ps(out + (lane + 4) * stride, _mm256_extractf128_ps(two[lane], 1));
    }
}

#elif !defined(SUPPLE_SCALAR_LANES) && defined(__AVX2__)

inline void load_points(const double* field, const std::int32_t* id, Lanes& x, Lanes& y, Lanes& z) {
    const __m256i xyz = _mm256_set_epi64x(0, -1, -1, -1);
    const auto at = [&](int lane) { return _mm256_maskload_pd(field + 3 * std::ptrdiff_t(id[lane]), xyz); };
    const __m256d a = at(0), b = at(1), c = at(2), d = at(3);
    const __m256d xz01 = _mm256_unpacklo_pd(a, b), y01 = _mm256_unpackhi_pd(a, b), xz23 = _mm256_unpacklo_pd(c, d), y23 = _mm256_unpackhi_pd(c, d);
    x = _mm256_permute2f128_pd(xz01, xz23, 0x20);
    y = _mm256_permute2f128_pd(y01, y23, 0x20);
    z = _mm256_permute2f128_pd(xz01, xz23, 0x31);
}

/// The four lanes, point by point.
inline void to_points(const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w, __m256d out[4]) {
    const __m256d xy_even = _mm256_unpacklo_pd(x, y), xy_odd = _mm256_unpackhi_pd(x, y), zw_even = _mm256_unpacklo_pd(z, w), zw_odd = _mm256_unpackhi_pd(z, w);
    out[0] = _mm256_permute2f128_pd(xy_even, zw_even, 0x20);
    out[1] = _mm256_permute2f128_pd(xy_odd, zw_odd, 0x20);
    out[2] = _mm256_permute2f128_pd(xy_even, zw_even, 0x31);
    out[3] = _mm256_permute2f128_pd(xy_odd, zw_odd, 0x31);
}

inline void store_points(double* out, std::size_t stride, const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w) {
    __m256d p[4];
    to_points(x, y, z, w, p);
    for (std::size_t lane = 0; lane < 4; ++lane) _mm256_store_pd(out + lane * stride, p[lane]);
}
inline void store_points(float* out, std::size_t stride, Floats x, Floats y, Floats z, Floats w) {
    __m128 a = __m128(x), b = __m128(y), c = __m128(z), d = __m128(w);
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _mm_store_ps(out, a);
    _mm_store_ps(out + stride, b);
    _mm_store_ps(out + 2 * stride, c);
    _mm_store_ps(out + 3 * stride, d);
}

#else

inline void load_points(const double* field, const std::int32_t* id, Lanes& x, Lanes& y, Lanes& z) {
    alignas(64) double c[3][kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
        for (int k = 0; k < 3; ++k) c[k][lane] = field[3 * std::ptrdiff_t(id[lane]) + k];
    x = load(c[0]);
    y = load(c[1]);
    z = load(c[2]);
}

inline void store_points(double* out, std::size_t stride, const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w) {
    alignas(64) double c[4][kLanes];
    store(c[0], x);
    store(c[1], y);
    store(c[2], z);
    store(c[3], w);
    for (std::size_t lane = 0; lane < std::size_t(kLanes); ++lane)
        for (std::size_t k = 0; k < 4; ++k) out[lane * stride + k] = c[k][lane];
}
inline void store_points(float* out, std::size_t stride, Floats x, Floats y, Floats z, Floats w) {
    float c[4][kLanes];
    const Floats* const from[4] = {&x, &y, &z, &w};
    for (std::size_t k = 0; k < 4; ++k) __builtin_memcpy(c[k], from[k], sizeof c[k]);
    for (std::size_t lane = 0; lane < std::size_t(kLanes); ++lane)
        for (std::size_t k = 0; k < 4; ++k) out[lane * stride + k] = c[k][lane];
}

#endif

inline void store_points(float* out, std::size_t stride, const Lanes& x, const Lanes& y, const Lanes& z, const Lanes& w) {
    store_points(out, stride, to_floats(x), to_floats(y), to_floats(z), to_floats(w));
}

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
