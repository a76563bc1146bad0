/* The pattern `{{ name }}` over a surface's colour: made by lichtenberg from the expression that its preview evaluates. Compile it
 * with sdrc (Pixie) or aqsl (Aqsis) beside the scene. */
surface {{ name }}(float Ka = 1, Kd = 1, Ks = 0, roughness = 0.1; color specularcolor = 1; float size = 1, mean = 0; color over = 0;)
{
    /* A limb stands along z of its own space, with x towards its upper side. `s` says how far along the whole limb that space begins;
     * it is below 0 where the limb is too thin for the pattern, which shows its mean there. */
    point p = transform("object", P) / size;
    float x = xcomp(p), y = zcomp(p) + s / size, z = ycomp(p);
    float share = mean;
    if (s >= 0) share = {{ share }};
    normal Nf = faceforward(normalize(N), I);
    Oi = Os;
    Ci = Os * (mix(Cs, over, share) * (Ka * ambient() + Kd * diffuse(Nf))
        + specularcolor * Ks * specular(Nf, -normalize(I), roughness));
}
