#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/solve/bsr3_kernels_impl.h"

namespace supple::solve {
extern const Bsr3Kernels<float> bsr3_kernels_f_scalar;
extern const Bsr3Kernels<double> bsr3_kernels_d_scalar;
const Bsr3Kernels<float> bsr3_kernels_f_scalar = scalar::kKernels<float>;
const Bsr3Kernels<double> bsr3_kernels_d_scalar = scalar::kKernels<double>;
}  // namespace supple::solve
