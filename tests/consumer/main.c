#include <stdio.h>
#include <supple/bindings/c/supple.h>

int main(void) {
    SuppleWorld* world = NULL;
    SuppleWorldDef def;
    supple_world_def_default(&def, sizeof def);
    if (supple_world_create(&def, &world) != SUPPLE_OK) return 1;
    printf("supple %s\n", supple_version());
    supple_world_destroy(world);
    return 0;
}
