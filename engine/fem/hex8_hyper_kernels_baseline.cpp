#define SUPPLE_ISA baseline
#include "supple/fem/hex8_hyper_kernels_impl.h"

namespace supple::fem {
extern const Hex8HyperKernels hex8_hyper_kernels_baseline;
const Hex8HyperKernels hex8_hyper_kernels_baseline = baseline::kHexHyperKernels;
}  // namespace supple::fem
