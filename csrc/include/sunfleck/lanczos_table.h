// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Made by make_lanczos_table.py: do not edit. Column: the integral of |sinc(x) sinc(x / 3)| over the
 * distance v from the zero at 1 inwards and outwards, 2 inwards and outwards, 3 inwards, over
 * v^2, by powers of v; then the masses of the lobes between the zeros, from the middle outwards. */
#ifndef SUNFLECK_LANCZOS_TABLE_H
#define SUNFLECK_LANCZOS_TABLE_H

#define SF_LANCZOS_TERMS_F 10

static const float sf_lanczos_table[10][5] = {
    {0.413496671913f,
     0.413496671564f,
     0.103374167891f,
     0.10337416789f,
     0.0f},
    {0.3846621595f,
     -0.384662227949f,
     0.110582778681f,
     -0.110582777947f,
     0.0370370370644f},
    {-0.083202562155f,
     -0.0832048779929f,
     -0.0433471522655f,
     -0.0433471829617f,
     0.0185185121703f},
    {-0.181183356433f,
     0.181155561696f,
     -0.096957634856f,
     0.0969585099006f,
     -0.0332080049564f},
    {-0.00316468997202f,
     -0.00335809545267f,
     -0.0127983010672f,
     -0.0128052461743f,
     -0.0198243910779f},
    {0.0428212144672f,
     -0.0434219129851f,
     0.0263975175012f,
     -0.0263363048221f,
     0.00915262327412f},
    {0.00560492653827f,
     0.00393461627361f,
     0.00683725402129f,
     0.00668195342874f,
     0.00685918162446f},
    {-0.00848613691399f,
     0.00717935760338f,
     -0.00383785090873f,
     0.00442429325001f,
     -0.000755187711006f},
    {0.000451457513673f,
     -0.00159382923521f,
     -0.00155580670328f,
     -0.00199559147173f,
     -0.00169250448253f},
    {0.000364379412067f,
     -0.00018914540825f,
     0.000645356373446f,
     0.000129071455298f,
     0.000415595461285f},
};

static const float sf_lanczos_lobes[3] = {0.571364063465f, 0.0893397661838f, 0.0165033756957f};

#endif
