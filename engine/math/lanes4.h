#pragma once
/// Four numbers side by side, x y z and a pad: the shape of a vertex and of a block column. GCC's and Clang's vector type, which
/// becomes one SSE, AVX or NEON register or two, as the unit's instruction set allows. Kernel units only, like lanes.h.
#ifndef SUPPLE_ISA
#error "only kernel units include this: define SUPPLE_ISA first"
#endif

#include <cstddef>
#include <cstdint>
#if defined(__AVX512F__) && defined(__AVX512BW__)
#include <immintrin.h>
#endif

namespace supple {
inline namespace SUPPLE_ISA {
namespace {

typedef float Float4 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));

template <class Real>
struct Four;
template <>
struct Four<float> {
    using type = Float4;
};
template <>
struct Four<double> {
    using type = Double4;
};
template <class Real>
using FourOf = typename Four<Real>::type;

/// Aligned to sixteen bytes (float) or thirty-two (double).
template <class Real>
inline FourOf<Real> load4(const Real* p) { return *reinterpret_cast<const FourOf<Real>*>(p); }
template <class Real>
inline void store4(Real* p, FourOf<Real> v) { *reinterpret_cast<FourOf<Real>*>(p) = v; }

template <int i, class V>
inline V splat(V v) { return __builtin_shufflevector(v, v, i, i, i, i); }

typedef std::int16_t Short8 __attribute__((vector_size(16)));
typedef std::int32_t Int4 __attribute__((vector_size(16)));
typedef std::int64_t Long2 __attribute__((vector_size(16)));

/// Four 16-bit integers as floats; aligned to eight bytes, reads sixteen.
inline Float4 widen4(const std::int16_t* p) {
    Short8 v;
    __builtin_memcpy(&v, p, sizeof v);
    const Short8 zero = {0, 0, 0, 0, 0, 0, 0, 0};
    const Int4 high = (Int4)__builtin_shufflevector(zero, v, 0, 8, 1, 9, 2, 10, 3, 11);  // in the upper halves
    return __builtin_convertvector(high >> 16, Float4);
}

/// The nearest 16-bit integers of four numbers; what lies outside +-32767 is cut off there.
inline void store_rounded4(std::int16_t* p, Float4 v) {
    const Float4 most = {32767, 32767, 32767, 32767};
    v = v < most ? v : most;
    v = v > -most ? v : -most;
    const Float4 shifted = v + 12582912.0f;  // 1.5 * 2^23: leaves the rounded integer in the low bits
    const Short8 bits = (Short8)shifted;
    const Long2 low = (Long2)__builtin_shufflevector(bits, bits, 0, 2, 4, 6, 0, 2, 4, 6);
    __builtin_memcpy(p, &low, 8);
}

inline Float4 narrow(Float4 v) { return v; }
inline Float4 narrow(Double4 v) { return __builtin_convertvector(v, Float4); }

/// Twelve numbers times a factor, rounded to 16 bits.
template <class Real>
inline void store_rounded12(std::int16_t* to, const Real* from, float factor) {
    for (std::size_t c = 0; c < 12; c += 4) store_rounded4(to + c, factor * narrow(load4(from + c)));
}

/// Sum of products of 3x3 blocks with vectors; a block is three columns x y z and a pad, twelve numbers. A row's products go to
/// two sums in turn: an addition's latency is several products long.
template <class Real>
class BlockSum {
public:
    void add(const Real* block, const Real* x) {
        const FourOf<Real> v = load4(x);
        s0_ += load4(block) * splat<0>(v);
        s1_ += load4(block + 4) * splat<1>(v);
        s2_ += load4(block + 8) * splat<2>(v);
    }
    void add(const std::int16_t* block, const float* x) {
        const Float4 v = load4(x);
        s0_ += widen4(block) * splat<0>(v);
        s1_ += widen4(block + 4) * splat<1>(v);
        s2_ += widen4(block + 8) * splat<2>(v);
    }
    void merge(const BlockSum& other) {
        s0_ += other.s0_;
        s1_ += other.s1_;
        s2_ += other.s2_;
    }
    FourOf<Real> total() const { return s0_ + s1_ + s2_; }

private:
    FourOf<Real> s0_ = {0, 0, 0, 0}, s1_ = {0, 0, 0, 0}, s2_ = {0, 0, 0, 0};
};

/// A 3x3 block in three columns x y z and a pad that is zero: twelve numbers.
template <class Real>
class Block3 {
public:
    Block3() = default;
    explicit Block3(const FourOf<Real> c[3]) : c_{c[0], c[1], c[2]} {}
    void add(const Real* block) {
        for (int k = 0; k < 3; ++k) c_[k] += load4(block + 4 * k);
    }
    void add(const Block3& other) {
        for (int k = 0; k < 3; ++k) c_[k] += other.c_[k];
    }
    void scale(Real factor) {
        for (int k = 0; k < 3; ++k) c_[k] *= factor;
    }
    void add_to_diagonal(Real value) {
        for (int k = 0; k < 3; ++k) c_[k][k] += value;
    }
    Block3 transposed() const {
        Block3 t;
        for (int k = 0; k < 3; ++k) t.c_[k] = FourOf<Real>{c_[0][k], c_[1][k], c_[2][k], 0};
        return t;
    }
    void store(Real* to) const {
        for (int k = 0; k < 3; ++k) store4(to + 4 * k, c_[k]);
    }

private:
    FourOf<Real> c_[3] = {};
};

/// Sums over pairs of vectors of s a b^T + b a^T, a 3x3 block.
template <class Real>
class PairSum {
public:
    /// a, b: x y z and a fourth number that does not matter
    void add(const Real* a, const Real* b, Real s) {
        const FourOf<Real> u = load4(a), v = load4(b), su = s * u, b0 = splat<0>(v), b1 = splat<1>(v), b2 = splat<2>(v);
        for_[0] += su * b0;
        for_[1] += su * b1;
        for_[2] += su * b2;
        back_[0] += u * b0;
        back_[1] += u * b1;
        back_[2] += u * b2;
    }
    Block3<Real> block() const {
        FourOf<Real> c[3];
        for (int k = 0; k < 3; ++k) c[k] = FourOf<Real>{for_[k][0] + back_[0][k], for_[k][1] + back_[1][k], for_[k][2] + back_[2][k], 0};
        return Block3<Real>(c);
    }

private:
    FourOf<Real> for_[3] = {}, back_[3] = {};  ///< columns of the sums of s a b^T and a b^T
};

/// Sums over pairs of vectors of a b^T, a 3x3 block.
template <class Real>
class DyadSum {
public:
    /// a, b: x y z and a fourth number that does not matter
    void add(const Real* a, const Real* b) {
        const FourOf<Real> u = load4(a), v = load4(b);
        sum_[0] += u * splat<0>(v);
        sum_[1] += u * splat<1>(v);
        sum_[2] += u * splat<2>(v);
    }
    Block3<Real> block() const {
        FourOf<Real> c[3];
        for (int k = 0; k < 3; ++k) c[k] = FourOf<Real>{sum_[k][0], sum_[k][1], sum_[k][2], 0};
        return Block3<Real>(c);
    }

private:
    FourOf<Real> sum_[3] = {};
};

#if defined(__AVX512F__) && defined(__AVX512BW__)
/// x y z of p spread over the quarters of a register, and p in every quarter.
inline __m512 spread3(const float* p) {
    const __m512i order = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
    return _mm512_permutevar_ps(_mm512_broadcast_f32x4(_mm_load_ps(p)), order);
}

template <>
class Block3<float> {
public:
    Block3() = default;
    explicit Block3(__m512 v) : v_(v) {}
    void add(const float* block) { v_ = _mm512_add_ps(v_, _mm512_maskz_loadu_ps(0x0fff, block)); }
    void add(const Block3& other) { v_ = _mm512_add_ps(v_, other.v_); }
    void scale(float factor) { v_ = _mm512_mul_ps(v_, _mm512_set1_ps(factor)); }
    void add_to_diagonal(float value) { v_ = _mm512_mask_add_ps(v_, 0x0421, v_, _mm512_set1_ps(value)); }
    Block3 transposed() const {
        return Block3(_mm512_permutexvar_ps(_mm512_set_epi32(15, 15, 15, 15, 15, 10, 6, 2, 15, 9, 5, 1, 15, 8, 4, 0), v_));
    }
    void store(float* to) const {
        _mm256_storeu_ps(to, _mm512_castps512_ps256(v_));
        _mm_store_ps(to + 8, _mm512_extractf32x4_ps(v_, 2));
    }

private:
    __m512 v_ = _mm512_setzero_ps();
};

template <>
class PairSum<float> {
public:
    void add(const float* a, const float* b, float s) {
        const __m512 u = _mm512_broadcast_f32x4(_mm_load_ps(a)), v = spread3(b);
        for_ = _mm512_fmadd_ps(_mm512_mul_ps(u, _mm512_set1_ps(s)), v, for_);
        back_ = _mm512_fmadd_ps(u, v, back_);
    }
    Block3<float> block() const {
        // The first twelve numbers of for_ + back_^T, 3x3 within quarters.
        const __m512i turned = _mm512_set_epi32(15, 15, 15, 15, 15, 10, 6, 2, 15, 9, 5, 1, 15, 8, 4, 0);
        return Block3<float>(_mm512_maskz_mov_ps(0x0777, _mm512_add_ps(for_, _mm512_permutexvar_ps(turned, back_))));
    }

private:
    __m512 for_ = _mm512_setzero_ps(), back_ = _mm512_setzero_ps();
};

template <>
class DyadSum<float> {
public:
    void add(const float* a, const float* b) { sum_ = _mm512_fmadd_ps(_mm512_broadcast_f32x4(_mm_load_ps(a)), spread3(b), sum_); }
    Block3<float> block() const { return Block3<float>(_mm512_maskz_mov_ps(0x0777, sum_)); }

private:
    __m512 sum_ = _mm512_setzero_ps();
};

inline void store_rounded12(std::int16_t* to, const float* from, float factor) {
    const __m512 v = _mm512_mul_ps(_mm512_maskz_loadu_ps(0x0fff, from), _mm512_set1_ps(factor));
    const __m256i rounded = _mm512_cvtsepi32_epi16(_mm512_cvtps_epi32(v));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_castsi256_si128(rounded));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 8), _mm256_extracti128_si256(rounded, 1));
}

/// One multiplication per block: the columns side by side in one register, x y z spread over them.
template <>
class BlockSum<float> {
public:
    void add(const float* block, const float* x) { sum_ = _mm512_fmadd_ps(_mm512_maskz_loadu_ps(0x0fff, block), spread3(x), sum_); }
    /// Reads eight bytes past the block.
    void add(const std::int16_t* block, const float* x) {
        const __m512i wide = _mm512_cvtepi16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(block)));
        sum_ = _mm512_fmadd_ps(_mm512_cvtepi32_ps(wide), spread3(x), sum_);
    }
    void merge(const BlockSum& other) { sum_ = _mm512_add_ps(sum_, other.sum_); }
    Float4 total() const {
        const __m256 low = _mm512_castps512_ps256(sum_);
        return Float4(_mm_add_ps(_mm_add_ps(_mm256_castps256_ps128(low), _mm256_extractf128_ps(low, 1)), _mm512_extractf32x4_ps(sum_, 2)));
    }

private:
    __m512 sum_ = _mm512_setzero_ps();
};
#endif

}  // namespace
}  // namespace SUPPLE_ISA
}  // namespace supple
