#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/element_products.h"
#include "supple/fem/hex8.h"

namespace supple::fem {

struct HexStiffness;

/// Products with the stiffness of hexahedra in a frame, element by element: no matrix is made, so a step that needs few products is spared its assembly,
/// and what is read for each is the rotations and one stiffness for all elements of one shape. Elements come in groups of sixteen: one AVX-512 batch of
/// floats; groups in chunks, whose corners are summed where they are in the cache.
inline constexpr std::size_t kProductLanes = 16;
inline constexpr std::size_t kProductChunk = 16;                                     ///< groups in a chunk
inline constexpr std::size_t kChunkPlaces = kProductChunk * kProductLanes * 8;       ///< most vertices that a chunk touches
inline constexpr std::size_t kDense = 21 * 21;                                       ///< inner stiffness, as the product goes through it: [3][column][7 rows]
inline constexpr std::size_t kHexDiagonal = 8;                                       ///< [xx yy zz xy yz zx 0 0]

/// Tables of one shape: of unit size and unit shear modulus.
template <class Real>
struct HexProductClass {
    alignas(64) Real stiffness[kDense];
    Real diagonal[8][6];     ///< diagonal blocks of the corners
    Real gradient[7][3];     ///< mean gradients, as in Hex8Rest
};

/// The same of sixteen elements of several shapes.
template <class Real>
struct HexProductMix {
    alignas(64) Real stiffness[kDense][kProductLanes];
    Real diagonal[8][6][kProductLanes];
    Real gradient[7][3][kProductLanes];
};

/// What the kernels read; arrays of HexProducts.
template <class Real>
struct HexProductView {
    const std::uint32_t* first = nullptr;    ///< [chunk + 1] where the places of a chunk begin
    const std::int32_t* row = nullptr;       ///< [place]
    const std::uint16_t* corner = nullptr;   ///< [group][8][lane] place in the chunk
    const std::int64_t* class_of = nullptr;  ///< [group] its class, or -1 - its mix
    const HexProductClass<Real>* classes = nullptr;
    const HexProductMix<Real>* mixes = nullptr;
    Real* turn = nullptr;                    ///< [group][9][lane] R sqrt(factor of the stiffness), by rows
    Real* twist = nullptr;                   ///< [group][6][lane] V T over the stiffness's factor, of unit size; null: none
    std::size_t groups = 0;
};

/// Where turn and twist come from.
struct HexTurns {
    const double* quaternion = nullptr;  ///< [block][w x y z][lane]
    const double* twist = nullptr;       ///< [block][xx yy zz xy yz zx][lane] (Hex8Pass), or null
    const double* scale = nullptr;       ///< [block][lane] (HexStiffness)
    const double* size = nullptr;        ///< [block][lane] of the elements [m]
    std::size_t blocks = 0;
    double factor = 1;
};

/// Rows of a product from its sums in the chunks.
template <class Real>
struct HexProductRows {
    const std::int32_t* start = nullptr;   ///< [row + 1]
    const std::uint32_t* place = nullptr;
    const Real* value = nullptr;           ///< [place][x y z 0]
    const Real* mass = nullptr;            ///< [row]
};

template <class Real>
struct HexProductKernelsOf {
    void (*turn)(const HexTurns& from, const HexProductView<Real>& to, std::size_t begin, std::size_t end);                        ///< groups
    void (*multiply)(const HexProductView<Real>& K, const Real* x, Real* value, std::size_t begin, std::size_t end);               ///< chunks; value: [place][x y z 0]
    void (*diagonal)(const HexProductView<Real>& K, Real* value, std::size_t begin, std::size_t end);                              ///< chunks; value: [place][kHexDiagonal]
    double (*rows)(const HexProductRows<Real>& from, const Real* x, Real* y, std::size_t begin, std::size_t end);                  ///< y = mass x + sums; returns x . y
    void (*diagonal_rows)(const HexProductRows<Real>& from, Real* block, std::size_t begin, std::size_t end);                      ///< value: [place][kHexDiagonal]; block: [row][column][x y z 0]
};

struct HexProductKernels {
    HexProductKernelsOf<float> single;
    HexProductKernelsOf<double> twice;
    template <class Real>
    const HexProductKernelsOf<Real>& of() const {
        if constexpr (sizeof(Real) == 4) {
            return single;
        } else {
            return twice;
        }
    }
};
const HexProductKernels& hex_product_kernels(Isa isa);

/// Where the products of one group of hexahedra are summed: which vertices each chunk of them touches, and the places of each row.
struct HexProductLists {
    std::size_t elements = 0;
    std::vector<std::uint32_t> first;
    std::vector<std::int32_t> row;
    std::vector<std::uint16_t> corner;
    std::vector<std::int64_t> class_of;
    std::vector<std::int32_t> start;
    std::vector<std::uint32_t> place;
    std::vector<std::array<std::int32_t, kProductLanes>> mixed;  ///< the classes in the lanes of each mix
    std::size_t groups() const { return class_of.size(); }
    std::size_t chunks() const { return first.size() - 1; }
};

/// Part of the elements that lie in groups of one shape, 0..1.
double shared_part(const HexStiffness& stiffness);

/// ElementProducts of one group of hexahedra in a frame.
template <class Real>
class HexProducts final : public ElementProducts<Real> {
public:
    /// @param row  [vertex] in the vectors
    HexProducts(const Hex8Rest& rest, const HexStiffness& stiffness, std::span<const std::int32_t> row, Isa isa);

    /// Takes in new rotations. twist null: rotations held.
    void turn(Team& team, const double* quaternion, const double* twist, const HexStiffness& stiffness, double factor);
    void multiply(Team& team, const Real* x) override;
    double rows(const Real* mass, const Real* x, Real* y, std::size_t begin, std::size_t end) const override;
    void diagonal(Team& team, const Real* mass, Real* block) override;
    double traffic() const override;
    std::size_t row_count() const { return lists_.start.size() - 1; }

private:
    HexProductView<Real> view();

    const HexProductKernelsOf<Real>& kernels_;
    HexProductLists lists_;
    AlignedVector<HexProductClass<Real>> classes_;
    AlignedVector<HexProductMix<Real>> mixes_;
    AlignedVector<double> size_;
    AlignedVector<Real> turn_, twist_, value_, diagonal_;
    bool twisted_ = false;
};

}  // namespace supple::fem
