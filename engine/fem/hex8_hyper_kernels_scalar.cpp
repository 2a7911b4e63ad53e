#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/fem/hex8_hyper_kernels_impl.h"

namespace supple::fem {
extern const Hex8HyperKernels hex8_hyper_kernels_scalar;
const Hex8HyperKernels hex8_hyper_kernels_scalar = scalar::kHexHyperKernels;
}  // namespace supple::fem
