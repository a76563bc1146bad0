/* A point light as POV-Ray has it: with `fade_distance` (here `fade`; 0 for none) and `fade_power 2`. Pixie traces its shadows;
 * Aqsis has none for it. Compile it with sdrc (Pixie) or aqsl (Aqsis) beside the scene. */
light fadepoint(float intensity = 1; color lightcolor = 1; point from = point "shader" (0, 0, 0); float fade = 0, traced = 0;)
{
    illuminate(from) {
        float share = 1;
        if (fade > 0) share = 2 / (1 + (L . L) / (fade * fade));
        Cl = intensity * share * lightcolor;
#ifdef PIXIE
        if (traced > 0) Cl *= transmission(Ps, from);
#endif
    }
}
