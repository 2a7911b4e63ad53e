#include <supple/io/mesh_file.h>
#include <supple/io/scene.h>

int main() {
    try {
        supple::io::read_mesh("does-not-exist.msh");
    } catch (const supple::Error& error) {
        return error.code() == supple::ErrorCode::file_unreadable ? 0 : 1;
    }
    return 1;
}
