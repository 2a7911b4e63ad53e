#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/fem/hex8_kernels_impl.h"

namespace supple::fem {
extern const Hex8Kernels hex8_kernels_scalar;
const Hex8Kernels hex8_kernels_scalar = scalar::kHexKernels;
}  // namespace supple::fem
