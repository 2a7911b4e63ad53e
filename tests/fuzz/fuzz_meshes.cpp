// libFuzzer target over every reader of meshes and surfaces. run.sh builds and runs it.
#include "one_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    supple::fuzz::read_as_everything(data, size);
    return 0;
}
