/* A leaf: it scatters light on the side where it falls, and lets some through, which is scattered beyond; its lower side, towards which N
 * points, may be paler. Made by lichtenberg; compile it
 * with sdrc (Pixie) or aqsl (Aqsis) beside the scene. */
surface leaf(float Ka = 1, Kd = 1, Kt = 0, paler = 0, Ks = 0, roughness = 0.1; color specularcolor = 1;)
{
    normal Nf = faceforward(normalize(N), I);
    Oi = Os;
    color shown = Cs;
    if (N . I < 0) shown = mix(Cs, color 1, paler);
    Ci = Os * (shown * (Ka * ambient() + Kd * diffuse(Nf) + Kt * diffuse(-Nf))
        + specularcolor * Ks * specular(Nf, -normalize(I), roughness));
}
