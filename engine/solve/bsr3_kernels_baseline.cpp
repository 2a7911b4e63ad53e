#define SUPPLE_ISA baseline
#include "supple/solve/bsr3_kernels_impl.h"

namespace supple::solve {
extern const Bsr3Kernels<float> bsr3_kernels_f_baseline;
extern const Bsr3Kernels<double> bsr3_kernels_d_baseline;
const Bsr3Kernels<float> bsr3_kernels_f_baseline = baseline::kKernels<float>;
const Bsr3Kernels<double> bsr3_kernels_d_baseline = baseline::kKernels<double>;
}  // namespace supple::solve
