#pragma once
#include "supple/fem/hex8.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

/// Numbers of a Gauss point at rest: gradients of the corners 1..7 and the weight w |J| [m^3].
inline constexpr std::size_t kHexPoint = 22;

/// [block][point][kHexPoint][lane]; free lanes repeat the last element.
AlignedVector<double> make_hex_points(const Hex8Rest& rest);

struct Hex8HyperPass {
    const std::int32_t* vertex = nullptr;
    const double* gradient = nullptr;
    const double* volume = nullptr;
    const double* point = nullptr;
    const double* parameter = nullptr;      ///< as in Tet4HyperPass
    std::size_t parameters = 0;
    const double* fibre = nullptr;          ///< as in Tet4HyperPass; I4 is that of Fb
    std::size_t families = 0;
    const double* position = nullptr;
    bool project = true;                    ///< tangent made positive semidefinite

    double* quaternion = nullptr;           ///< [block][w x y z][lane]: of the mean F; warm start in, rotation out
    double* corner_force = nullptr;         ///< out [element][corner][x y z 0]
    double* energy = nullptr;               ///< out [block][lane]
    double* stress = nullptr;               ///< out [block][xx yy zz xy yz zx][lane], volume mean, Cauchy
    double* inner = nullptr;                ///< out [block][kHexInner][lane]: the tangent stiffness
    float* block_f = nullptr;               ///< out [element][kHexBlocks], the same for the matrix; needs inner
    double* block_d = nullptr;
};

struct Hex8HyperKernels {
    void (*elements[kLaws])(const Hex8HyperPass& pass, std::size_t begin, std::size_t end);
};

const Hex8HyperKernels& hex8_hyper_kernels(Isa isa);

}  // namespace supple::fem
