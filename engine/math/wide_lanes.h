#pragma once
/// Batches of floats or of doubles, the widest that the instruction set has, and points [x y z 0] picked into their lanes and added up from them. Kernel units only, like lanes.h.
#include "supple/math/lane_mat3.h"
#include "supple/math/lanes4.h"

#if !defined(SUPPLE_SCALAR_LANES) && defined(__AVX2__)
#include <immintrin.h>
#endif

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

#if defined(SUPPLE_SCALAR_LANES)
template <class Real>
using WideOf = Real;
template <class Real>
inline constexpr std::size_t kWide = 1;
template <class Real>
inline Real get(const Real* p) { return *p; }
template <class Real>
inline void put(Real* p, Real v) { *p = v; }
#else
template <class Real>
using WideOf = xsimd::batch<Real>;
template <class Real>
inline constexpr std::size_t kWide = xsimd::batch<Real>::size;
template <class Real>
inline xsimd::batch<Real> get(const Real* p) { return xsimd::batch<Real>::load_aligned(p); }
template <class Real>
inline void put(Real* p, const xsimd::batch<Real>& v) { v.store_aligned(p); }
#endif

/// x y z of the points id[lane] of a field of [x y z 0].
template <class Real>
inline void take_points(const Real* field, const std::uint16_t* id, V3<WideOf<Real>>& v) {
    alignas(64) Real c[3][kWide<Real>];
    for (std::size_t lane = 0; lane < kWide<Real>; ++lane)
        for (std::size_t k = 0; k < 3; ++k) c[k][lane] = field[4 * std::size_t(id[lane]) + k];
    v = {get(c[0]), get(c[1]), get(c[2])};
}

/// Adds x y z w of every lane to its point, lane by lane; a point is `stride` numbers.
template <class Real>
inline void add_points(Real* field, std::size_t stride, const std::uint16_t* id, const V3<WideOf<Real>>& v, const WideOf<Real>& w) {
    alignas(64) Real c[4][kWide<Real>];
    put(c[0], v.x);
    put(c[1], v.y);
    put(c[2], v.z);
    put(c[3], w);
    for (std::size_t lane = 0; lane < kWide<Real>; ++lane) {
        Real* to = field + stride * std::size_t(id[lane]);
        store4(to, load4(to) + FourOf<Real>{c[0][lane], c[1][lane], c[2][lane], c[3][lane]});
    }
}

#if !defined(SUPPLE_SCALAR_LANES) && defined(__AVX512F__)
template <>
inline void take_points<float>(const float* field, const std::uint16_t* id, V3<xsimd::batch<float>>& v) {
    const auto at = [&](std::size_t lane) { return _mm_load_ps(field + 4 * std::size_t(id[lane])); };
    const auto quad = [&](std::size_t lane) {  // four lanes apart, so that the transposes below end in order
        __m512 q = _mm512_castps128_ps512(at(lane));
        q = _mm512_insertf32x4(q, at(lane + 4), 1);
        q = _mm512_insertf32x4(q, at(lane + 8), 2);
        return _mm512_insertf32x4(q, at(lane + 12), 3);
    };
    const __m512 a = quad(0), b = quad(1), c = quad(2), d = quad(3);
    const __m512 ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
    v.x = _mm512_shuffle_ps(ab, cd, _MM_SHUFFLE(1, 0, 1, 0));
    v.y = _mm512_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 2, 3, 2));
    v.z = _mm512_shuffle_ps(_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d), _MM_SHUFFLE(1, 0, 1, 0));
}
template <>
inline void add_points<float>(float* field, std::size_t stride, const std::uint16_t* id, const V3<xsimd::batch<float>>& v, const xsimd::batch<float>& w) {
    const __m512 xy = _mm512_unpacklo_ps(v.x, v.y), zw = _mm512_unpacklo_ps(v.z, w), xy2 = _mm512_unpackhi_ps(v.x, v.y), zw2 = _mm512_unpackhi_ps(v.z, w);
    const auto add = [&](std::size_t lane, __m128 p) {
        float* to = field + stride * std::size_t(id[lane]);
        _mm_store_ps(to, _mm_add_ps(_mm_load_ps(to), p));
    };
    const auto quad = [&](std::size_t lane, __m512 p) {
        add(lane, _mm512_castps512_ps128(p));
        add(lane + 4, _mm512_extractf32x4_ps(p, 1));
        add(lane + 8, _mm512_extractf32x4_ps(p, 2));
        add(lane + 12, _mm512_extractf32x4_ps(p, 3));
    };
    quad(0, _mm512_shuffle_ps(xy, zw, _MM_SHUFFLE(1, 0, 1, 0)));
    quad(1, _mm512_shuffle_ps(xy, zw, _MM_SHUFFLE(3, 2, 3, 2)));
    quad(2, _mm512_shuffle_ps(xy2, zw2, _MM_SHUFFLE(1, 0, 1, 0)));
    quad(3, _mm512_shuffle_ps(xy2, zw2, _MM_SHUFFLE(3, 2, 3, 2)));
}
#elif !defined(SUPPLE_SCALAR_LANES) && defined(__AVX2__)
template <>
inline void take_points<float>(const float* field, const std::uint16_t* id, V3<xsimd::batch<float>>& v) {
    const auto at = [&](std::size_t lane) { return _mm_load_ps(field + 4 * std::size_t(id[lane])); };
    const auto pair = [&](std::size_t lane) { return _mm256_insertf128_ps(_mm256_castps128_ps256(at(lane)), at(lane + 4), 1); };
    const __m256 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
    const __m256 ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d);
    v.x = _mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(1, 0, 1, 0));
    v.y = _mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 2, 3, 2));
    v.z = _mm256_shuffle_ps(_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d), _MM_SHUFFLE(1, 0, 1, 0));
}
template <>
inline void add_points<float>(float* field, std::size_t stride, const std::uint16_t* id, const V3<xsimd::batch<float>>& v, const xsimd::batch<float>& w) {
    const __m256 xy = _mm256_unpacklo_ps(v.x, v.y), zw = _mm256_unpacklo_ps(v.z, w), xy2 = _mm256_unpackhi_ps(v.x, v.y), zw2 = _mm256_unpackhi_ps(v.z, w);
    const auto add = [&](std::size_t lane, __m128 p) {
        float* to = field + stride * std::size_t(id[lane]);
        _mm_store_ps(to, _mm_add_ps(_mm_load_ps(to), p));
    };
    const auto pair = [&](std::size_t lane, __m256 p) {
        add(lane, _mm256_castps256_ps128(p));
        add(lane + 4, _mm256_extractf128_ps(p, 1));
    };
    pair(0, _mm256_shuffle_ps(xy, zw, _MM_SHUFFLE(1, 0, 1, 0)));
    pair(1, _mm256_shuffle_ps(xy, zw, _MM_SHUFFLE(3, 2, 3, 2)));
    pair(2, _mm256_shuffle_ps(xy2, zw2, _MM_SHUFFLE(1, 0, 1, 0)));
    pair(3, _mm256_shuffle_ps(xy2, zw2, _MM_SHUFFLE(3, 2, 3, 2)));
}
#endif

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
