/* The pattern `{{ name }}` over a surface's colour: made by lichtenberg from the expression that its preview evaluates. Compile it
 * with sdrc (Pixie) or aqsl (Aqsis) beside the scene. */
surface {{ name }}(float Ka = 1, Kd = 1, Ks = 0, roughness = 0.1; color specularcolor = 1; float size = 1, mean = 0, height = 0; color over = 0;)
{
    /* A limb stands along z of its own space, with x towards its upper side. `s` says how far along the whole limb that space begins,
     * `t` how much of the pattern it shows: thinner limbs show more of its mean. */
    point p = transform("object", P) / size;
    float x = xcomp(p), y = zcomp(p) + s / size, z = ycomp(p);
    float share = mean;
    normal Nn = normalize(N);
    if (t > 0) {
        float full = {{ share }};
        share = mix(mean, full, t);
        if (height != 0) Nn = normalize(calculatenormal(P + Nn * (full * t * height * size)));
    }
    normal Nf = faceforward(Nn, I);
    Oi = Os;
    Ci = Os * (mix(Cs, over, share) * (Ka * ambient() + Kd * diffuse(Nf))
        + specularcolor * Ks * specular(Nf, -normalize(I), roughness));
}
