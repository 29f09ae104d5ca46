// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Philox behind sf_rng, for words of 32 and 64 bits alike: included once for each, with METHOD
 * (philox4x32, philox4x64) and WORD defined, and after blocks_before_carry_METHOD. */

static void SF_JOIN(start_block, METHOD)(SF_JOIN(sf, METHOD) * g, unsigned used) {
    SF_JOIN(SF_JOIN(sf, METHOD), block)(g->counter, g->key, g->block);
    for (int i = 0; i < 4 && ++g->counter[i] == 0; ++i) {
    }
    g->used = used;
}

static void SF_JOIN(add_blocks, METHOD)(SF_JOIN(sf, METHOD) * g, uint64_t blocks) {
    for (int i = 0; i < 4 && blocks; ++i) {
        WORD before = g->counter[i];
        g->counter[i] = (WORD)(before + blocks);
        blocks = (blocks >> (sizeof(WORD) * 4) >> (sizeof(WORD) * 4)) + (g->counter[i] < before);
    }
}

static void SF_JOIN(draw, METHOD)(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    SF_JOIN(sf, METHOD) *g = &rng->as.METHOD;
    WORD *words = out;
    for (; count && g->used < 4; --count) *words++ = g->block[g->used++];
    while (count >= 4) {
        uint64_t blocks = count / 4, room = SF_JOIN(blocks_before_carry, METHOD)(g);
        if (blocks > room) blocks = room;
        kernels->METHOD(g->counter, g->key, (size_t)blocks, words);
        SF_JOIN(add_blocks, METHOD)(g, blocks);
        words += 4 * blocks;
        count -= 4 * (size_t)blocks;
    }
    if (!count) return;
    SF_JOIN(start_block, METHOD)(g, 0);
    for (; count; --count) *words++ = g->block[g->used++];
}

static void SF_JOIN(skip, METHOD)(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    SF_JOIN(sf, METHOD) *g = &rng->as.METHOD;
    uint64_t left = 4 - g->used;
    if (count < left) {
        g->used += (WORD)count;
        return;
    }
    SF_JOIN(add_blocks, METHOD)(g, (count - left) / 4);
    g->used = 4;
    if ((count - left) % 4) SF_JOIN(start_block, METHOD)(g, (unsigned)((count - left) % 4));
}

static const char *SF_JOIN(fault, METHOD)(const sf_rng *rng) {
    SF_JOIN(sf, METHOD) g = rng->as.METHOD;
    WORD block[4];
    if (g.used > 4) return "of a block of four words, 0 .. 4 are used";
    for (int i = 0; i < 4 && g.counter[i]-- == 0; ++i) {
    }
    SF_JOIN(SF_JOIN(sf, METHOD), block)(g.counter, g.key, block);
    return g.used == 4 || memcmp(block, g.block, sizeof block) == 0 ? NULL
                                                                    : "the block is not that of the counter before";
}

#undef METHOD
#undef WORD
