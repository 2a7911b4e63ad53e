#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/solve/packed_kernels_impl.h"

namespace supple::solve {
extern const PackedKernels packed_kernels_scalar;
const PackedKernels packed_kernels_scalar = scalar::kPackedKernels;
}  // namespace supple::solve
