#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "supple/base/aligned.h"
#include "supple/math/isa.h"

namespace supple::fem {

/// Elements come in blocks of eight: one AVX-512 batch of doubles, two of AVX2, four of SSE2.
/// A field of a block is eight consecutive numbers. Lanes past the last element repeat it with zero volume.
inline constexpr std::size_t kBlock = 8;

/// Rest shape of linear tetrahedra, ready for the kernels.
struct Tet4Rest {
    std::size_t elements = 0;
    std::size_t vertices = 0;
    std::size_t blocks() const { return (elements + kBlock - 1) / kBlock; }

    AlignedVector<std::int32_t> vertex;  ///< [block][corner 0..3][lane]
    AlignedVector<double> gradient;      ///< [block][g1x g1y g1z g2x .. g3z][lane] [1/m]; g0 = -(g1 + g2 + g3)
    AlignedVector<double> volume;        ///< [block][lane] [m^3]
};

/// What a kernel pass reads and writes; null outputs are not computed. Arrays as in Tet4Rest.
struct Tet4Pass {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* moduli = nullptr;       ///< [block][lambda mu][lane] [Pa]
    const double* position = nullptr;     ///< [vertex][3] [m]

    const double* plastic = nullptr;      ///< [block][xx yy zz xy yz zx][lane] plastic strain in the element's frame (tensor shears); null: none
    const double* pressure = nullptr;     ///< [block][lane] added to the mean stress [Pa] (nodal_volume.h); null: none
    bool project = true;                  ///< twist: eigenvalues below zero are set to zero

    double* quaternion = nullptr;         ///< [block][w x y z][lane]: warm start in (polar), rotation of the element out
    double* twist = nullptr;              ///< out [block][xx yy zz xy yz zx][lane] twist stiffness T in the frame, polar and svd only [Pa]
    float* twist_f = nullptr;             ///< out [element][xx yy zz xy yz zx 0 0] R T R^T / (2 mu), with twist
    double* twist_d = nullptr;
    double* corner_force = nullptr;       ///< out [element][corner][x y z 0] [N], elastic force on each corner, from the first element of corner_block on
    std::size_t corner_block = 0;
    float* record_f = nullptr;            ///< out, element record (below), float32 or float64
    double* record_d = nullptr;
    double* energy = nullptr;             ///< out [block][lane] [J]
    double* dilatation = nullptr;         ///< out [block][lane] tr(e)
    double* stress = nullptr;             ///< out [block][xx yy zz xy yz zx][lane], Cauchy [Pa]
};

/// An element record is what the stiffness blocks are made of: [corner][x y z] the rotated rest gradient sqrt(mu V) R g_a, and in the fourth
/// place of corner 0 lambda / mu, of corner 1 1 / sqrt(mu V) (zeros where mu V is zero). 16 numbers: one cache line in float32.
inline constexpr std::size_t kRecord = 16;

/// Plastic flow of a step, added to the strain kept in the frame of each element:
///     e = sym(R^T F) - I - e_p,  e' = dev e;   e_p += flow (|e'| - yield)+ e'/|e'|,   then |e_p| <= cap.
struct Tet4Flow {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* position = nullptr;
    const double* parameter = nullptr;    ///< [block][yield cap flow][lane]: flow = 1 - exp(-c h)
    double* quaternion = nullptr;
    double* plastic = nullptr;            ///< in and out
};
inline constexpr std::size_t kFlowParameters = 3;
inline constexpr std::size_t kTwistRecord = 8;

/// K d for a field d, with the rotations held, or, where twist is given, with their derivative.
struct Tet4Product {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* moduli = nullptr;
    const double* quaternion = nullptr;
    const double* twist = nullptr;        ///< as in Tet4Pass, or null
    const double* pressure = nullptr;     ///< [block][lane] added to the mean stress, or null
    const double* field = nullptr;        ///< [vertex][3]
    double* dilatation = nullptr;         ///< out [block][lane] tr(R^T dF); with it nothing else is computed
    double* corner_force = nullptr;       ///< out [element][corner][x y z 0]: (K d) corner by corner, from the first element of corner_block on
    std::size_t corner_block = 0;
};

/// Blocks of the stiffness matrix, gathered one by one from element records, in the order of an AssemblyOrder: those above the diagonal with their mirrors, then diagonal ones.
template <class Real>
struct Tet4Assembly {
    std::size_t above = 0, diagonal = 0;         ///< how many
    const std::uint32_t* block = nullptr;        ///< [above + diagonal] index of the matrix block
    const std::uint32_t* partner = nullptr;      ///< [above + diagonal] index of the transposed block; of diagonal blocks the row
    const std::uint16_t* count = nullptr;        ///< [above + diagonal] contributions
    const std::uint32_t* contribution = nullptr; ///< element * 16 + corner_of_row * 4 + corner_of_column
    const double* laplacian = nullptr;           ///< [above + diagonal] sum of mu V g_a.g_b [N/m]
    const Real* record = nullptr;
    const Real* twist = nullptr;                 ///< twist records (Tet4Pass), or null
    bool uniform = false;                        ///< lambda / mu of all elements is `ratio`
    double ratio = 0;
    const double* diagonal_shift = nullptr;      ///< [row] added to the diagonal: (1 + h alpha) m; null: all is added to what `value` holds
    double stiffness_scale = 1;                  ///< h^2 + h beta
    Real* value = nullptr;                       ///< out [block][column 0..2][x y z 0]
};

/// How an element finds its frame: `rest` never turns (small displacements), the others as in material.h.
enum class Frame { rest, large, polar, svd };
inline constexpr std::size_t kFrames = 4;

struct Tet4Kernels {
    /// [frame] Rotation, and any of force, record, energy, stress, of the blocks [begin, end).
    void (*elements[kFrames])(const Tet4Pass& pass, std::size_t begin, std::size_t end);
    /// Plastic flow; frames rest, large, polar, svd.
    void (*flow[kFrames])(const Tet4Flow& pass, std::size_t begin, std::size_t end);
    void (*product)(const Tet4Product& pass, std::size_t begin, std::size_t end);
    void (*assemble_f)(const Tet4Assembly<float>& pass);
    void (*assemble_d)(const Tet4Assembly<double>& pass);
};

/// Kernels of one instruction set; it must be supported (math/isa.h).
const Tet4Kernels& tet4_kernels(Isa isa);

}  // namespace supple::fem
