#include "supple/fem/hex8_kernels.h"

#include "supple/base/assert.h"
#include "supple/fem/hex8_hyper.h"

namespace supple::fem {

extern const Hex8Kernels hex8_kernels_scalar, hex8_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const Hex8Kernels hex8_kernels_avx2, hex8_kernels_avx512;
#endif

extern const Hex8HyperKernels hex8_hyper_kernels_scalar, hex8_hyper_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const Hex8HyperKernels hex8_hyper_kernels_avx2, hex8_hyper_kernels_avx512;
#endif

const Hex8Kernels& hex8_kernels(Isa isa) {
    SUPPLE_ASSERT(is_supported(isa));
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return hex8_kernels_avx2;
        case Isa::avx512: return hex8_kernels_avx512;
#endif
        case Isa::scalar: return hex8_kernels_scalar;
        default: return hex8_kernels_baseline;
    }
}

const Hex8HyperKernels& hex8_hyper_kernels(Isa isa) {
    SUPPLE_ASSERT(is_supported(isa));
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return hex8_hyper_kernels_avx2;
        case Isa::avx512: return hex8_hyper_kernels_avx512;
#endif
        case Isa::scalar: return hex8_hyper_kernels_scalar;
        default: return hex8_hyper_kernels_baseline;
    }
}

}  // namespace supple::fem
