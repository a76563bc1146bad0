/* Thorns on the limbs of a coral (Xu and Mould 2007, Fig. 12), as tall as `height`, about `apart` from each other and as wide as
 * `radius` at their foot. Compile it with sdrc (Pixie) or aqsl (Aqsis) beside the scene. */
displacement thorns(float height = 0.1; float radius = 0.05; float apart = 0.2;)
{
    /* One thorn a cell of a lattice in the object's own space, somewhere within it. */
    point p = transform("shader", P) / apart;
    float far = 10;
    float i, j, k;
    for (i = -1; i <= 1; i += 1) {
        for (j = -1; j <= 1; j += 1) {
            for (k = -1; k <= 1; k += 1) {
                point cell = point(floor(xcomp(p)) + i, floor(ycomp(p)) + j, floor(zcomp(p)) + k);
                point at = cell + 0.2 + 0.6 * point(cellnoise(cell + 11), cellnoise(cell + 23), cellnoise(cell + 37));
                far = min(far, distance(p, at));
            }
        }
    }
    float rise = 1 - smoothstep(0, radius / apart, far - 0.1);
    P += normalize(N) * height * rise * rise;
    N = calculatenormal(P);
}
