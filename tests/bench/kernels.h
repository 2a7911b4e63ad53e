#pragma once
#include "machine.h"

namespace supple::bench {

const demos::Machine& machine();  ///< measured once, when first asked for

// Each registers its benchmarks; all run on one thread, on bodies that fit the shared cache and on one that does not.
void register_element_kernels();  ///< element passes by law and instruction set, assembly
void register_solve_kernels();    ///< matrix-vector product, preconditioners

}  // namespace supple::bench
